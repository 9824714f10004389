#include "core/sleeping_barrier.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

TEST(SleepingBarrier, OneThreadDoesNotWait) {
  SleepingBarrier barrier(1);
  barrier.wait();
  barrier.wait();
}

}  // namespace
}  // namespace spherical_param::internal
