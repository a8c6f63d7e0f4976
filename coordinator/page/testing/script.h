// A script in the place of `cairn`, in a folder that goes with it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace cairn::page {

class Script {
 public:
  Script() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cairn-page-test-XXXXXX").string();
    base_ = ::mkdtemp(pattern.data());
  }
  ~Script() {
    std::error_code ignored;
    std::filesystem::remove_all(base_, ignored);
  }
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;

  // $BASE is the folder; the words that it is called with are in Words(), a line a call.
  void Does(const std::string& what) {
    std::ofstream(program()) << "#!/bin/sh\nBASE='" << base_.string() << "'\necho \"$@\" >>\"$BASE/words\"\n"
                             << what << "\n";
    std::filesystem::permissions(program(), std::filesystem::perms::owner_all);
  }
  const std::filesystem::path& base() const { return base_; }
  std::string program() const { return (base_ / "cairn").string(); }
  std::string Words() const { return Said("words"); }
  void Forget() { std::filesystem::remove(base_ / "words"); }
  // What is in a file of the folder.
  std::string Said(const std::string& file) const {
    std::stringstream text;
    text << std::ifstream(base_ / file).rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path base_;
};

}  // namespace cairn::page
