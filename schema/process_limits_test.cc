#include "schema/process_limits.h"

#include <fcntl.h>
#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "schema/job.pb.h"

namespace cairn {
namespace {

// The soft limit alone, so that it can be set back.
class Limited {
 public:
  Limited(decltype(RLIMIT_NOFILE) resource, rlim_t soft) : resource_(resource) {
    ::getrlimit(resource_, &before_);
    const rlimit low{soft, before_.rlim_max};
    EXPECT_EQ(::setrlimit(resource_, &low), 0);
  }
  ~Limited() { ::setrlimit(resource_, &before_); }
  Limited(const Limited&) = delete;
  Limited& operator=(const Limited&) = delete;

 private:
  decltype(RLIMIT_NOFILE) resource_;
  rlimit before_{};
};

TEST(ProcessLimits, TheMemoryToHaveIsTheLeastThatAGroupLeaves) {
  std::string name = ::testing::TempDir() + "groups-XXXXXX";
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path dir = name;
  const std::uint64_t machine = MemoryToHave(dir / "none", dir);
  EXPECT_EQ(machine, static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)));
  std::filesystem::create_directories(dir / "all/batch/job");
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(dir / name) << text << '\n';
  };
  write("self", "0::/batch/job");
  write("all/batch/job/memory.max", "max");
  const auto to_have = [&] { return MemoryToHave(dir / "self", dir / "all"); };
  EXPECT_EQ(to_have(), machine);
  write("all/batch/memory.max", "20000000");
  EXPECT_EQ(to_have(), 20000000u);
  write("all/memory.max", "30000000");
  write("all/batch/job/memory.max", "10000000");
  EXPECT_EQ(to_have(), 10000000u);
  write("self", "3:cpu:/batch/job\n0::/");  // a container sees its own group as the root
  EXPECT_EQ(to_have(), 30000000u);
  write("self", "4:memory:/old/one\n0::/");
  std::filesystem::create_directories(dir / "all/memory/old/one");
  write("all/memory/old/memory.limit_in_bytes", "5000000");
  write("all/memory/old/one/memory.limit_in_bytes", "9223372036854771712");
  EXPECT_EQ(to_have(), 5000000u);
  std::filesystem::remove_all(dir);
}

TEST(ProcessLimits, TheSoftLimitOnOpenFilesIsRaised) {
  const Limited limited(RLIMIT_NOFILE, 20);
  ASSERT_TRUE(PrepareProcess({.files = 32}).ok());
  rlimit now{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &now), 0);
  EXPECT_GE(now.rlim_cur, 32u);
}

TEST(ProcessLimits, WhatIsTooLowIsSaidWithWhatIsNeeded) {
  rlimit files{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &files), 0);
  const Status few = PrepareProcess({.files = files.rlim_max + 1});
  EXPECT_EQ(few.code(), Code::kRefused);
  EXPECT_NE(few.message().find("ulimit -n"), std::string::npos) << few.message();
  const Limited limited(RLIMIT_FSIZE, 8192);
  EXPECT_TRUE(PrepareProcess({}).ok()) << "it writes no file";
  const Status small = PrepareProcess({.file_bytes = 64 << 20});
  EXPECT_EQ(small.code(), Code::kRefused);
  EXPECT_NE(small.message().find("grow to 8 KiB here, and it needs 64 MiB"), std::string::npos)
      << small.message();
}

// A child, which gives up the right of root to have as many as it likes.
TEST(ProcessLimits, ThreadsThatCannotBeHadAreSaid) {
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::setresuid(kNobody, kNobody, kNobody) != 0) ::_exit(3);
    const rlimit low{1, 1};
    if (::setrlimit(RLIMIT_NPROC, &low) != 0) ::_exit(4);
    const Status few = PrepareProcess({.threads = 3});
    const bool said = few.message().starts_with(
        "the system lets this user have 1 processes and threads at a time, of which 0 are "
        "left for this one, and it needs 3: raise the limit (ulimit -u");
    ::_exit(few.code() == Code::kRefused && said ? 0 : 5);
  }
  int ended = 0;
  ASSERT_EQ(::waitpid(child, &ended, 0), child);
  ASSERT_TRUE(WIFEXITED(ended));
  EXPECT_EQ(WEXITSTATUS(ended), 0);
  EXPECT_TRUE(PrepareProcess({.threads = 16}).ok());
}

// Beyond it lies no write that fails, but the end of the process.
TEST(ProcessLimits, AStackThatIsTooSmallIsSaid) {
  const Limited limited(RLIMIT_STACK, 64 << 10);
  const Status small = PrepareProcess({});
  EXPECT_EQ(small.code(), Code::kRefused);
  EXPECT_NE(
      small.message().find("threads grow to 64 KiB here, and it needs 1 MiB at the least: raise the limit "
                           "(ulimit -s 8192)"),
      std::string::npos)
      << small.message();
}

// A text that is no UTF-8, and what protobuf itself calls fatal.
TEST(ProcessLimits, WhatProtobufSaysOfBadBytesIsForNobody) {
  ASSERT_TRUE(PrepareProcess({}).ok());
  proto::Task task;
  const std::string bytes = "\x12\x02\xff\x1b";  // `kind`
  testing::internal::CaptureStderr();
  EXPECT_FALSE(task.ParseFromString(bytes));
  EXPECT_THROW(GOOGLE_LOG(FATAL) << "\x1b[2J", google::protobuf::FatalException);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Else a log goes into whatever file was opened first: a lock, a key.
TEST(ProcessLimits, NoFileTakesThePlaceOfAClosedStandardStream) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    for (const int stream : {0, 1, 2}) ::close(stream);
    bool right = PrepareProcess({}).ok();
    right &= ::open("/dev/null", O_RDWR) > 2;
    char byte = 0;
    right &= ::read(0, &byte, 1) < 0 && ::write(1, &byte, 1) < 0 && ::write(2, &byte, 1) < 0;
    ::_exit(right ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(ProcessLimits, AFileThatMayNotGrowIsAWriteThatFailsAndNotTheEnd) {
  ASSERT_TRUE(PrepareProcess({}).ok());
  std::string name = ::testing::TempDir() + "limits-XXXXXX";
  const int fd = ::mkstemp(name.data());
  ASSERT_GE(fd, 0);
  const std::string bytes(4096, 'x');
  {
    const Limited limited(RLIMIT_FSIZE, bytes.size());
    EXPECT_EQ(::write(fd, bytes.data(), bytes.size()), 4096);
    EXPECT_EQ(::write(fd, bytes.data(), bytes.size()), -1);
    EXPECT_EQ(errno, EFBIG);
  }
  ::close(fd);
  ::unlink(name.c_str());
}

}  // namespace
}  // namespace cairn
