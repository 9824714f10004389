#include "common/command_line.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "formats/formats.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

const OptionTable kOptions = {{"k", "N", "neighbours", false},
                              {"kind", "NAME", "of graph", true},
                              {"quiet", "", "print nothing", false}};

TEST(CommandLine, TakesOptionsInEveryNotationAndOrder) {
  const std::vector<std::vector<std::string>> notations = {
      {"in", "out", "-k", "7", "-kind", "x", "-quiet"},
      {"--quiet", "--k", "7", "in", "--kind", "x", "out"},
      {"-kind=x", "in", "-k=7", "-quiet", "out"},
      {"in", "--k=7", "out", "--quiet", "--kind=x"},
  };
  for (const std::vector<std::string>& words : notations) {
    const CommandLine line(words, kOptions);
    EXPECT_EQ(line.value("k", "none"), "7");
    EXPECT_EQ(line.value("kind", "none"), "x");
    EXPECT_TRUE(line.has("quiet"));
    EXPECT_EQ(line.others(), (std::vector<std::string>{"in", "out"}));
  }
  EXPECT_EQ(CommandLine({"in"}, kOptions).value("k", "none"), "none");
  EXPECT_EQ(CommandLine({"-k", "-7"}, kOptions).value("k", ""), "-7");
  EXPECT_EQ(CommandLine({"-", "--", "-k"}, kOptions).others(),
            (std::vector<std::string>{"-", "-k"}));
  for (const char* known : {"h", "help", "version"})
    EXPECT_TRUE(CommandLine({std::string("--") + known}, kOptions).has(known));
}

TEST(CommandLine, UnknownOptionsAreAnsweredWithTheNearest) {
  const auto remedy = [](const std::string& word) -> std::string {
    try {
      CommandLine({word}, kOptions);
    } catch (const UsageError& error) {
      return error.remedy();
    }
    return "";
  };
  EXPECT_EQ(remedy("-quite").rfind("did you mean -quiet? ", 0), 0U);
  EXPECT_EQ(remedy("--kinds=x").rfind("did you mean -kind? ", 0), 0U);
  EXPECT_EQ(remedy("-verson").rfind("did you mean -version? ", 0), 0U);
}

TEST(CommandLine, HelpOfAllOptionsIsThatForExperts) {
  const std::string brief = describeOptions(kOptions, false);
  EXPECT_EQ(brief.find("-kind"), std::string::npos);
  EXPECT_NE(brief.find("-h expert"), std::string::npos);
  const std::string help = describeOptions(kOptions, true);
  std::size_t last = 0;
  for (const char* line : {"  -k N ", "  -quiet ", "\nExpert options:\n", "  -kind NAME "}) {
    const std::size_t place = help.find(line);
    ASSERT_NE(place, std::string::npos) << line;
    EXPECT_GE(place, last) << line;
    last = place;
  }
}

TEST(Numbers, AreTheWholeTextAndNothingElse) {
  EXPECT_EQ(toReal("+.25"), 0.25);
  EXPECT_EQ(toReal("-1e-3"), -1e-3);
  EXPECT_EQ(toReal("1e999"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(toReal("-1e-999"), 0.0);
  EXPECT_EQ(toInteger("+5"), 5);
  for (const char* text : {"", "+", "+-1", "1x", " 1", "0,5", "0x5"}) {
    EXPECT_EQ(toReal(text), std::nullopt) << text;
    EXPECT_EQ(toInteger(text), std::nullopt) << text;
  }
  EXPECT_EQ(toInteger("25.5"), std::nullopt);
  EXPECT_EQ(toInteger("99999999999999999999"), std::nullopt);
}

TEST(Numbers, OfOptionsAreInTheirRange) {
  int integer = 5;
  double real = 0.5;
  Encoding encoding = Encoding::Binary;
  const OptionTable options = {
      numberOption("k", "", integer, 3, 9), numberOption("x", "", real, 0, 1),
      choiceOption("kind", "", encoding,
                   Names<Encoding>{{"binary", Encoding::Binary}, {"ascii", Encoding::Ascii}})};
  EXPECT_EQ(optionsToJson(options).dump(), R"({"k":5,"x":0.5,"kind":"binary"})");
  CommandLine({"-k", "9", "-x=0", "-kind", "ascii"}, options).apply(options);
  EXPECT_EQ(optionsToJson(options).dump(), R"({"k":9,"x":0.0,"kind":"ascii"})");
  for (const char* text : {"2", "10", "x", "4.5", ""})
    EXPECT_THROW(options[0].take(text), UsageError) << text;
  for (const char* text : {"-1e-9", "1.001", "nan", "inf", "1e999", ""})
    EXPECT_THROW(options[1].take(text), UsageError) << text;
  EXPECT_THROW(options[2].take("text"), UsageError);
}

}  // namespace
}  // namespace spherical_param::tools
