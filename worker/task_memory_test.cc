#include "worker/task_memory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#include "worker/testing/rig.h"

namespace cairn::worker {
namespace {

constexpr std::size_t kMb = 1 << 20;

// What a compiler cannot see through.
void* Take(std::size_t bytes) {
  void* volatile block = ::operator new(bytes, std::nothrow);
  return block;
}

TEST(TaskMemoryTest, HoldsWhatIsLiveToTheLimitAndNotWhatWasFreed) {
  TaskMemory memory(8, 0);
  {
    const TaskMemory::Hold hold(memory);
    for (int i = 0; i < 10; ++i) {
      void* const block = Take(6 * kMb);
      EXPECT_NE(block, nullptr) << i;
      ::operator delete(block);
    }
    EXPECT_EQ(Take(9 * kMb), nullptr);
  }
  EXPECT_EQ(memory.WhyRefused(), "it would have taken more than 8 MB of memory, its limit (task_memory_mb)");
  ::operator delete(Take(9 * kMb));
}

TEST(TaskMemoryTest, EveryWayToMemoryIsCounted) {
  TaskMemory memory(1, 0);
  const TaskMemory::Hold hold(memory);
  void* volatile block = std::malloc(2 * kMb);
  EXPECT_EQ(block, nullptr);
  block = std::calloc(2, kMb);
  EXPECT_EQ(block, nullptr);
  block = std::aligned_alloc(64, 2 * kMb);
  EXPECT_EQ(block, nullptr);
  void* aligned = nullptr;
  EXPECT_EQ(posix_memalign(&aligned, 64, 2 * kMb), ENOMEM);
  block = std::malloc(16);
  void* const grown = std::realloc(block, 2 * kMb);
  EXPECT_EQ(grown, nullptr);
  std::free(block);
  EXPECT_THROW(std::vector<char> much(2 * kMb), std::bad_alloc);
}

TEST(TaskMemoryTest, TheLowerOfTheTwoLimitsWinsAndIsNamed) {
  const auto why = [](std::uint64_t job_mb, std::uint64_t worker_mb) {
    TaskMemory memory(job_mb, worker_mb);
    {
      const TaskMemory::Hold hold(memory);
      ::operator delete(Take(5 * kMb));
    }
    return memory.WhyRefused();
  };
  EXPECT_NE(why(2, 3).find("2 MB of memory, its limit (task_memory_mb)"), std::string::npos);
  EXPECT_NE(why(3, 2).find("2 MB of memory, this worker's limit"), std::string::npos);
  EXPECT_NE(why(0, 2).find("2 MB of memory, this worker's limit"), std::string::npos);
  EXPECT_EQ(why(0, 0), "") << "no limit";
  EXPECT_EQ(why(std::numeric_limits<std::uint64_t>::max(), 0), "") << "as good as none";
}

TEST(TaskMemoryTest, OtherThreadsAndPausesAreNotTheTasks) {
  TaskMemory memory(1, 0);
  {
    const TaskMemory::Hold hold(memory);
    std::thread([] { ::operator delete(Take(4 * kMb)); }).join();
    const TaskMemory::Pause pause;
    ::operator delete(Take(4 * kMb));
  }
  EXPECT_EQ(memory.WhyRefused(), "");
}

// Task 0 takes 8 MB, others next to nothing.
Blob TakeMuch(const Task& task, const Inputs&, Progress&) {
  std::vector<double> much(task.index() == 0 ? kMb : 1, 1.0);
  return Number(much.back());
}

TEST(TaskMemoryTest, ATaskOverItsLimitFailsWithTheReasonAndTheNextSucceeds) {
  Rig rig(TakeMuch);
  rig.Begin();
  wire::Assign much = RunTask(0);
  much.set_memory_mb(4);
  rig.Assign(much);
  const wire::Message failed = rig.Serve();
  ASSERT_TRUE(failed.envelope.has_failed());
  EXPECT_FALSE(failed.envelope.failed().input_error()) << "another worker may have more";
  EXPECT_EQ(failed.envelope.failed().message(),
            "it would have taken more than 4 MB of memory, its limit (task_memory_mb)");
  wire::Assign little = RunTask(1);
  little.set_memory_mb(4);
  rig.Assign(little);
  EXPECT_TRUE(rig.Serve().envelope.has_done()) << "the worker lives on";
}

TEST(TaskMemoryTest, AWorkersOwnLimitHoldsWhateverTheJobSays) {
  Rig rig(TakeMuch, [](WorkerOptions& options) { options.task_memory_mb = 4; });
  rig.Begin();
  rig.Assign(RunTask(0));
  const wire::Message failed = rig.Serve();
  ASSERT_TRUE(failed.envelope.has_failed());
  EXPECT_NE(failed.envelope.failed().message().find("(--task-memory-mb)"), std::string::npos);
}

TEST(TaskMemoryTest, ATaskThatMadeDoWithLessHasFailedToo) {
  Rig rig([](const Task&, const Inputs&, Progress&) {
    double value = 1;
    try {
      value = std::vector<double>(kMb, 2.0).back();
    } catch (const std::bad_alloc&) {
    }
    return Number(value);
  });
  rig.Begin();
  wire::Assign assign = RunTask(0);
  assign.set_memory_mb(4);
  rig.Assign(assign);
  EXPECT_TRUE(rig.Serve().envelope.has_failed()) << "its result would depend on the limit";
}

}  // namespace
}  // namespace cairn::worker
