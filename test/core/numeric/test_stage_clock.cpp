#include "stage_clock.h"

#include "core/reconstructions.h"

#include <chrono>

namespace spherical_param::test {
namespace {

using Names = std::vector<std::string>;

TEST(StageClock, APartHasItsFractionOfTheRemainingTimeAndLaterStagesKeepTheirs) {
  Execution user;
  StageClock unlimited(user);
  unlimited.beginPart(0, 2, 0.5, 0.5);
  EXPECT_FALSE(unlimited.remaining().has_value());
  EXPECT_TRUE(unlimited.hasTimeAgain());
  user.time_limit = 1e6;
  StageClock clock(user);
  for (const double fraction : {0.25, 1.0}) {  // neither of them uses its time
    clock.beginPart(0, 2, fraction, 0.1);
    EXPECT_NEAR(*clock.remaining(), 1e6 * fraction, 1e3);
  }
  clock.keep(0.2);
  EXPECT_NEAR(*clock.limited().time_limit, 0.8e6, 1e3);
  user.time_limit = 0.4;
  StageClock half(user);
  EXPECT_TRUE(half.hasTimeAgain());
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  EXPECT_FALSE(half.hasTimeAgain());
}

TEST(StageClock, StagesAndPartsComeInOrder) {
  const Positions sphere = spiralSphere(200);
  const Positions points = horizontally(sphere, movedTo(4.0, sphere), 2.0 * spiralSphere(4));
  const Names of_part{"openings",  "optimization", "smoothing", "cleaning",
                      "embedding", "fill",         "quality"};
  Names expected;
  for (const char* name : {"neighbors", "graph", "outliers", "neighbors", "graph", "parts"})
    expected.push_back(name + std::string(" 0/1"));
  for (const char* part : {" 0/2", " 1/2"}) {
    expected.push_back("neighbors" + std::string(part));
    expected.push_back("graph" + std::string(part));
    for (const std::string& name : of_part)
      expected.push_back(name + part);
  }
  Options options = given("outliers", "auto", "parts", "each", "smoothing", 1, "fill", "smooth");
  options.details = true;  // which need the sphere
  Names names;
  std::string stage;
  double done = 0.0;
  options.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.done, done);
    done = progress.done;
    if (stage != progress.stage)
      names.push_back(progress.stage + (" " + std::to_string(progress.part)) + "/" +
                      std::to_string(progress.parts));
    stage = progress.stage;
    return true;
  };
  const Result result = reconstruct(points, options);
  EXPECT_EQ(names, expected);
  EXPECT_NEAR(done, 1.0, 1e-9);
  Names timed{"neighbors", "graph", "outliers", "parts"};
  timed.insert(timed.end(), of_part.begin(), of_part.end());
  ASSERT_EQ(result.stages.size(), timed.size());
  for (std::size_t i = 0; i < timed.size(); ++i) {
    EXPECT_EQ(result.stages[i].name, timed[i]);
    EXPECT_GE(result.stages[i].seconds, 0.0);
  }
}

TEST(StageClock, WhatTheCloudIsIsSaidOnceBeforeItIsMeshed) {
  const auto remark_on = [](const Positions& points, const Options& given = {}) {
    Options options = given;
    std::string all;
    bool is_early = true;
    options.progress = [&](const Progress& progress) {
      is_early = is_early && progress.stage != std::string("optimization");
      EXPECT_TRUE(progress.remark.empty() || is_early);
      all += progress.remark;
      return true;
    };
    reconstruct(points, options);
    return all;
  };
  const Positions rings =
      gridOf(12, 60, [](int ring, int i) { return onCircle(2.0 * kPi / 60 * i, 1.0, 0.3 * ring); });
  EXPECT_EQ(remark_on(spiralSphere(1000)), "");
  EXPECT_EQ(remark_on(noisySphere(600, 1.0)),
            "noisy; points move to the surface that they sample, and merge");
  EXPECT_EQ(remark_on(rings), "lines of points; the surface between them is a guess");
  EXPECT_EQ(remark_on(randomCube(3000, 1)),
            "a volume, without a surface; triangles that are certain are kept, if they are enough");
  EXPECT_EQ(remark_on(randomCube(3000, 1), sphere()),
            "a volume, without a surface; its triangles will intersect");
}

TEST(StageClock, EveryStageOfALargeCloudReportsWhileItWorks) {
  std::map<std::string, std::vector<double>> fractions;
  for (Options options : {Options(), sphere()}) {
    options.progress = [&](const Progress& progress) {
      fractions[progress.stage].push_back(progress.fraction);
      return true;
    };
    surfaceOf(spiralSphere(40000), options);
  }
  ASSERT_EQ(fractions.size(), 12U);
  for (const auto& [stage, of_stage] : fractions) {
    EXPECT_TRUE(areFractions(of_stage)) << stage;
    EXPECT_EQ(of_stage.front(), 0.0) << stage;
    EXPECT_EQ(of_stage.back(), 1.0) << stage;
    EXPECT_GE(of_stage.size(), 3U) << stage;  // two of them its begin and end
  }
}

}  // namespace
}  // namespace spherical_param::test
