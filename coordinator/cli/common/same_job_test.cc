#include "coordinator/cli/common/same_job.h"

#include <gtest/gtest.h>

#include "schema/error.h"

namespace cairn::cli {
namespace {

TEST(SameJob, AnotherJobWithTheSameIdIsNotFollowed) {
  wire::JobInfo info;
  info.set_id("7-hall");
  info.set_mark("one");
  SameJob same;
  same.Check(info);
  info.set_state("paused");
  same.Check(info);
  info.set_mark("other");
  EXPECT_THROW(same.Check(info), InputError);
}

}  // namespace
}  // namespace cairn::cli
