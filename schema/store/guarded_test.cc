#include "schema/store/guarded.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdarg>
#include <new>

#include "schema/store/testing.h"

namespace {
int told_when_forked = -1;  // a pipe; then the next PR_SET_PDEATHSIG comes too late
}

// In the place of the C library's.
extern "C" int prctl(int option, ...) {
  std::va_list arguments;
  va_start(arguments, option);
  const auto value = va_arg(arguments, unsigned long);
  va_end(arguments);
  if (option == PR_SET_PDEATHSIG && told_when_forked >= 0) {
    const pid_t parent = ::getppid();
    static_cast<void>(!::write(told_when_forked, "x", 1));
    while (::getppid() == parent) ::usleep(1000);
  }
  return static_cast<int>(::syscall(SYS_prctl, option, value, 0UL, 0UL, 0UL));
}

namespace cairn::store {
namespace {

using store_testing::OddBlob;

TEST(InChild, BringsBackWhatIsRead) {
  const Blob blob = OddBlob();
  const Result<FileContents> contents = InChild("/nowhere", [&]() -> Result<FileContents> {
    FileContents made{"log", 1, {}, blob};
    for (const auto& [name, array] : blob.fields())
      made.datasets.push_back({name, array.type(), array.item_bytes(), array.shape(), "m", 7});
    made.datasets.push_back({"not read", DType::kF64, 8, {3, 2}, "s", 48});
    return made;
  });
  ASSERT_TRUE(contents.ok()) << contents.status().message();
  EXPECT_EQ(contents.value().kind, "log");
  EXPECT_EQ(contents.value().format, 1);
  EXPECT_EQ(contents.value().blob.ContentHash(), blob.ContentHash());
  ASSERT_EQ(contents.value().datasets.size(), blob.fields().size() + 1);
  EXPECT_EQ(contents.value().datasets.back().shape, (Shape{3, 2}));
  EXPECT_EQ(contents.value().datasets.back().stored_bytes, 48u);
  EXPECT_EQ(contents.value().datasets.back().unit, "s");
}

TEST(InChild, BringsBackARefusal) {
  const Status status = InChild("a.h5", []() -> Result<FileContents> {
                          return Status(Code::kVersion, "a.h5: too new");
                        }).status();
  EXPECT_EQ(status.code(), Code::kVersion);
  EXPECT_EQ(status.message(), "a.h5: too new");
}

TEST(InChild, ACrashIsAStatusThatNamesTheFile) {
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) {
    const Status status = InChild("a.h5", [number]() -> Result<FileContents> {
                            std::signal(number, SIG_DFL);
                            ::raise(number);
                            return FileContents{};
                          }).status();
    EXPECT_EQ(status.code(), Code::kCorrupt);
    EXPECT_EQ(status.message(), "a.h5: damaged; HDF5 crashed while reading it");
  }
}

TEST(InChild, WhatComesToNoEndIsStopped) {
  const Status status = InChild("a.h5", []() -> Result<FileContents> {
                          const rlimit soon{1, 2};
                          ::setrlimit(RLIMIT_CPU, &soon);
                          const std::atomic<bool> ended{false};
                          while (!ended) {
                          }
                          return FileContents{};
                        }).status();
  EXPECT_EQ(status.code(), Code::kRefused);
  EXPECT_NE(status.message().find("a.h5: not read: it takes more than the 10 s of the processor's time"),
            std::string::npos)
      << status.message();
}

TEST(InChild, WhoeverIsKilledIsNotCalledDamaged) {
  const Status status = InChild("a.h5", []() -> Result<FileContents> {
                          ::raise(SIGKILL);
                          return FileContents{};
                        }).status();
  EXPECT_EQ(status.code(), Code::kIo);
  EXPECT_NE(status.message().find("a.h5: not read"), std::string::npos) << status.message();
  EXPECT_NE(status.message().find("want of memory"), std::string::npos) << status.message();
}

TEST(InChild, WantOfMemoryIsSaid) {
  const Status status = InChild("a.h5", []() -> Result<FileContents> { throw std::bad_alloc(); }).status();
  EXPECT_EQ(status.code(), Code::kIo);
  EXPECT_EQ(status.message(), "a.h5: there is not the memory to read it");
}

// The child's own descriptors, told in a message: the standard ones, its pipe, and the folder that lists
// them.
TEST(InChild, TheChildKeepsNothingOfItsParentsButItsPipe) {
  const int kept = ::open("/dev/null", O_RDONLY);
  const Status status = InChild("a.h5", []() -> Result<FileContents> {
                          std::string open;
                          for (int fd = 3; fd < 1000; ++fd)
                            if (::fcntl(fd, F_GETFD) >= 0) open += " " + std::to_string(fd);
                          return Status(Code::kIo, open);
                        }).status();
  ::close(kept);
  EXPECT_EQ(status.message(), " 3");
}

// A parent that dies between fork() and prctl(): the child waits for that in a prctl() of this test's own.
TEST(InChild, TheChildOfADeadParentReadsNothing) {
  const store_testing::TempFolder folder;
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // so that the orphan is ours to wait for
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    told_when_forked = ends[1];
    static_cast<void>(InChild("a.h5", [&]() -> Result<FileContents> {
      std::ofstream(folder / "read") << "read";
      return FileContents{};
    }));
    ::_exit(0);
  }
  char forked = 0;
  ASSERT_EQ(::read(ends[0], &forked, 1), 1);
  ::kill(parent, SIGKILL);
  EXPECT_EQ(::waitpid(parent, nullptr, 0), parent);
  EXPECT_GT(::waitpid(-1, nullptr, 0), 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "read"));
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace cairn::store
