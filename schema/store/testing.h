// Helpers of this folder's tests.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::store_testing {

// A folder of its own, removed at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cairn-store-XXXXXX").string();
    CAIRN_DEMAND(::mkdtemp(name.data()) != nullptr, "no temporary folder");
    path_ = name;
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename());
    return names;
  }

 private:
  std::filesystem::path path_;
};

inline std::string Text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::vector<std::byte> Bytes(const std::filesystem::path& path) {
  const std::string text = Text(path);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

inline void Overwrite(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

// `act` in a process whose files may have so many bytes.
inline bool WithSmallFiles(rlim_t bytes, const std::function<bool()>& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    ::_exit(::setrlimit(RLIMIT_FSIZE, &limit) == 0 && act() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Every type and every odd shape.
inline Blob OddBlob() {
  Blob blob;
  blob.PutVector<std::uint8_t>("types/u8", {0, 1, 255});
  blob.PutVector<std::int32_t>("types/i32", {-1, 0, 2147483647});
  blob.PutVector<std::int64_t>("types/i64", {INT64_MIN, 7});
  blob.PutVector<float>("types/f32", {1.5F, -0.0F});
  blob.PutVector<double>("types/time_s", {1e-300, 1.0 / 3.0, std::numeric_limits<double>::quiet_NaN()});
  blob.Put("types/texts", Array::Texts({"", "Grüße", "日本"}));
  blob.Put("shapes/scalar_m", Array::Scalar<double>(2.5));
  blob.Put("shapes/one", Array::Vector<double>({2.5}));
  blob.Put("shapes/none", Array::Vector<double>({}));
  blob.Put("shapes/no_rows", Array::Of<std::int32_t>({0, 3}, std::vector<std::int32_t>{}));
  blob.Put("shapes/no_columns", Array::Of<float>({3, 0, 2}, std::vector<float>{}));
  blob.Put("shapes/cube", Array::Of<float>({1, 2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6}));
  blob.Put("shapes/text", Array::Text("one text"));
  blob.Put("shapes/empty_text", Array::Text(""));
  blob.Put("shapes/no_texts", Array::Texts({}));
  blob.Put("näme with spaces/ü_rad", Array::Vector<double>({1}));
  return blob;
}

}  // namespace cairn::store_testing
