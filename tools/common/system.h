#pragma once

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>

/// What the standard library cannot do, and differs between operating systems.
namespace spherical_param::tools {

/// Whether the standard output is a terminal, which understands escape sequences.
bool isTerminal();

/// A standard stream that the caller has closed stays so, but no file gets its number: what is
/// meant for the terminal would be written into a mesh.
void occupyStandardStreams();

/// Keeps freed memory in the process: for large clouds, to return it to the system and to request
/// it again takes a noticeable part of the time.
void keepMemory();

/// Calls a function when the user or the system ends the tool. It is to call the function that it
/// is given, which ends the tool as the signal would have. Closed pipes and limits of the size of
/// files become errors of the write. To be called before there are other threads.
/// \throw std::system_error
void handleSignals(const std::function<void(const std::function<void()>&)>& at_end);

/// Opens a file for writing that does not exist yet. \param rights less those of the umask.
/// \return null: see errno, EEXIST if it exists
std::FILE* createFile(const std::string& path, std::filesystem::perms rights);

/// Opens what exists, such as a pipe or a device, for writing. \return null: see errno
std::FILE* openDevice(const std::string& path);

/// The error of errno that prevents writing a file, or creating one in a directory; 0: none.
int writeRefusal(const std::string& path);

/// Whether a file cannot grow, for the disk, its quota or a limit.
bool isLackOfSpace(const std::error_code& error);

#ifndef __cpp_lib_to_chars
/// strtod() in the locale "C", for libraries whose from_chars() reads no real numbers.
double strtodInC(const char* text, char** end);
#endif

}  // namespace spherical_param::tools
