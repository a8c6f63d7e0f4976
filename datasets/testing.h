// Helpers of this folder's tests: a folder of files that goes away, the message of an InputError, the real
// data.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/error.h"

namespace cairn::datasets {

class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cairn-datasets-XXXXXX").string();
    CAIRN_DEMAND(::mkdtemp(name.data()) != nullptr, "no temporary folder");
    path_ = name;
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  // Writes a file, gzipped where its name ends in .gz, and returns its path.
  std::string Put(const std::string& name, const std::string& text) const {
    const std::string path = *this / name;
    if (!name.ends_with(".gz")) {
      std::ofstream(path, std::ios::binary) << text;
      return path;
    }
    const gzFile file = gzopen(path.c_str(), "wb");
    CAIRN_DEMAND(file != nullptr, "cannot write " + path);
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
    return path;
  }

 private:
  std::filesystem::path path_;
};

inline std::string FileText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// What the InputError says that `function` throws; empty where it throws none.
template <class Function>
std::string InputErrorOf(Function function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

inline void ExpectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in '" << text << "'";
}

// An import's files and the log that it makes of them.
class ImportTest : public testing::Test {
 protected:
  TestFolder folder_;
  Blob log_;

  template <class T>
  std::vector<T> Column(const std::string& name) const {
    const auto values = log_.Get<T>(name);
    return {values.begin(), values.end()};
  }
};

// Folder of the third-party data, or empty.
inline std::string DataFolder() {
  const char* folder = std::getenv("CAIRN_DATA");
  return folder == nullptr ? "" : folder;
}

}  // namespace cairn::datasets
