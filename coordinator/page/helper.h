// `cairn` in a process of its own, for what pages do not do in theirs: to read a stranger's file, to plan, to
// submit. And a folder for what it leaves.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cairn::page {

// A folder of this process alone, in `base`, that goes with it; what processes left there that were killed
// goes now.
class OwnFolder {
 public:
  explicit OwnFolder(const std::filesystem::path& base);
  ~OwnFolder();
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;  // held while this lives
};

// What it may take before it is ended.
struct Most {
  double time_s = 0;
  std::uint64_t memory_bytes = 0;         // 0: no limit
  std::filesystem::path results_in = {};  // the .h5 files of this folder …
  std::uint64_t results_bytes = 0;        // … together
};

class Helper {
 public:
  struct Outcome {
    std::string printed;     // on its standard output
    std::string trouble;     // the last that it complained of, or why it did not run; empty: it did all
    bool bad_input = false;  // where that is at fault
    bool too_large = false;  // it was ended for its results
  };

  // `folder`: for what it says.
  Helper(std::string program, std::filesystem::path folder)
      : program_(std::move(program)), folder_(std::move(folder)) {}
  // Waits for it. In the folder `in`, where one is named. For one thread.
  Outcome Run(const std::vector<std::string>& words, const Most& most, const std::filesystem::path& in = {});
  // From any thread: ends what runs, and whatever runs later.
  void End();

 private:
  std::string program_;
  std::filesystem::path folder_;
  std::atomic<pid_t> running_ = 0;
  std::atomic<bool> ending_ = false;
};

}  // namespace cairn::page
