#include "schema/store/guarded.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <csignal>

#include "schema/store/testing.h"

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
  EXPECT_EQ(status.code(), Code::kCorrupt);
  EXPECT_EQ(status.message(), "a.h5: damaged; HDF5 comes to no end reading it");
}

}  // namespace
}  // namespace cairn::store
