#include "common/output_file.h"

#include "common/errors.h"
#include "temporary_directory.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;
using tool_test::readFile;
using tool_test::writeFile;
using Files = std::map<std::string, std::string>;

class OutputFileTest : public testing::Test {
protected:
  std::string path(const std::string& name) const { return directory.file(name); }

  const tool_test::TemporaryDirectory directory;
};

TEST_F(OutputFileTest, HasItsNameWhenItIsCompleteAndNoneBefore) {
  const std::string large((std::size_t{1} << 20U) + 1, 'x');  // more than what is kept in memory
  const auto write_mesh = [&](OutputFile& file) {
    for (const std::string& part : {std::string("a mesh, "), large, std::string(" and its end")})
      file.write(part);
  };
  for (const bool is_there : {false, true}) {
    const Files before = is_there ? Files{{"mesh.ply", "kept"}} : Files{};
    if (is_there)
      writeFile(path("mesh.ply"), "kept");
    {
      OutputFile file(path("mesh.ply"));
      file.write(large);
      file.finish();
      EXPECT_EQ(fs::exists(path("mesh.ply")) ? readFile(path("mesh.ply")) : "",
                is_there ? "kept" : "");
      // Without commit() nothing is left of it.
    }
    EXPECT_EQ(directory.listing(), before);
    {
      OutputFile file(path("mesh.ply"));
      write_mesh(file);
      removeTemporaryFiles([] {});
      EXPECT_EQ(directory.listing(), before);
      EXPECT_THROW(file.commit(), Failure);
    }
    EXPECT_EQ(directory.listing(), before);
    OutputFile file(path("mesh.ply"));
    write_mesh(file);
    file.commit();
    EXPECT_TRUE((directory.listing() == Files{{"mesh.ply", "a mesh, " + large + " and its end"}}));
    fs::remove(path("mesh.ply"));
  }
}

TEST_F(OutputFileTest, FollowsLinksAlsoToAFileThatDoesNotExistYet) {
  fs::create_symlink("second.ply", path("first.ply"));
  fs::create_symlink("mesh.ply", path("second.ply"));
  for (const char* content : {"a mesh", "another"}) {
    checkOutputPath(path("first.ply"));
    OutputFile file(path("first.ply"));
    file.write(content);
    file.commit();
    EXPECT_TRUE(fs::is_symlink(path("first.ply")));
    EXPECT_TRUE(fs::is_symlink(path("second.ply")));
    EXPECT_FALSE(fs::is_symlink(path("mesh.ply")));
    EXPECT_EQ(readFile(path("mesh.ply")), content);
  }
}

TEST_F(OutputFileTest, HasTheRightsOfTheOldFileOrThoseOfTheUmask) {
  const auto rights_of_new = [this] {
    OutputFile(path("mesh.ply")).commit();
    return fs::status(path("mesh.ply")).permissions();
  };
  const mode_t mask = umask(0027);
  EXPECT_EQ(rights_of_new(), fs::perms{0640});
  fs::permissions(path("mesh.ply"), fs::perms{0600});
  EXPECT_EQ(rights_of_new(), fs::perms{0600});
  umask(mask);
}

TEST_F(OutputFileTest, APipeIsWrittenInItsPlace) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  checkOutputPath(path("pipe"));
  OutputFile file(path("pipe"));
  file.write("a mesh");
  file.commit();
  std::string text(20, ' ');
  text.resize(static_cast<std::size_t>(read(reader, text.data(), text.size())));
  close(reader);
  EXPECT_EQ(text, "a mesh");
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_EQ(directory.listing().size(), 1U);
}

TEST_F(OutputFileTest, PathsOfOneFileAreTheSameWhetherItExistsOrNot) {
  fs::create_directory(path("sub"));
  for (const char* when : {"before it exists", "after"}) {
    SCOPED_TRACE(when);
    EXPECT_TRUE(isSameFile(path("a.ply"), path("sub/../a.ply")));
    EXPECT_FALSE(isSameFile(path("a.ply"), path("b.ply")));
    writeFile(path("a.ply"), "");
  }
  fs::create_hard_link(path("a.ply"), path("b.ply"));
  EXPECT_TRUE(isSameFile(path("a.ply"), path("b.ply")));
}

}  // namespace
}  // namespace spherical_param::tools
