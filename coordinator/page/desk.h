// What a job is started with from the pages: files that people brought, which lie in a folder of the page's
// that goes with it; and what `cairn`, in a process of its own, says of them, of pipelines, of what a job
// would take. No byte of a file is looked at here.
//
// All may be called from any thread, and wait for nobody; `then` is called on another thread, or this one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/http/http_server.h"
#include "coordinator/page/errands.h"
#include "coordinator/page/helper.h"

namespace cairn::page {

struct DeskOptions {
  std::string program;                       // the path of `cairn`
  std::vector<std::string> service;          // its options that say which coordinator: --connect …
  std::filesystem::path folder;              // in which a folder is made
  std::uint64_t most_bytes = 4'000'000'000;  // of all files together
};

struct BroughtFile {
  std::uint64_t number = 0;
  std::string name;  // fit for a path: letters, digits, '_', '-' and '.'
  std::uint64_t bytes = 0;
  bool looked_at = false;
  nlohmann::json content = nullptr;  // what `cairn inspect --json` says; null: nothing
  std::string trouble = {};          // why it is no file for a job; empty: it is one

  std::string Kind() const;  // "log"; empty: nothing that is known
};

// As a person ordered it; all of it is a stranger's text.
struct JobOrder {
  std::string pipeline = {}, name = {};
  std::uint64_t file = 0;                            // for the pipeline's first input
  std::map<std::string, std::uint64_t> inputs = {};  // for the others, by their names
  std::map<std::string, std::string> settings = {};  // options that are not their defaults
  std::string seed = {};                             // empty: 0
  std::string priority = {};
  bool units_are_right = false;
};

class Desk;

// A file on its way here. Where it breaks off nothing of it is left. One for which there is no room comes all
// the same, and is not kept: a browser hears why only when it has sent all.
class Upload : public coordinator::HttpUpload {
 public:
  Upload(Desk* desk, std::filesystem::path folder, std::string whose, std::string trouble)
      : desk_(desk),
        folder_(std::move(folder)),
        whose_(std::move(whose)),
        trouble_(std::move(trouble)),
        is_counted_(trouble_.empty()) {}
  ~Upload() override;
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;
  void Take(const std::string& field, const std::string& file, std::uint64_t at,
            std::string_view bytes) override;

 private:
  friend class Desk;
  void Open(const std::string& called);
  void Drop();

  Desk* desk_;
  std::filesystem::path folder_;
  const std::string whose_;
  std::string name_, trouble_;
  const bool is_counted_;
  std::uint64_t bytes_ = 0;
  int fd_ = -1;
  bool kept_ = false;
};

class Desk {
 public:
  static constexpr std::size_t kMostFiles = 32, kMostUploads = 4, kMostUploadsOfOne = 2;
  using Said = std::function<void(const Helper::Outcome&)>;

  explicit Desk(DeskOptions options);
  ~Desk();

  std::uint64_t most_bytes() const { return options_.most_bytes; }
  // `announced`: bytes, as whoever sends it says. `whose`: which session's.
  std::shared_ptr<Upload> Begin(std::uint64_t announced, const std::string& whose);
  // Of an upload that has come whole: its number, once it was looked at; 0 with the reason where it is none.
  void Keep(const std::shared_ptr<Upload>& upload,
            std::function<void(std::uint64_t, const std::string&)> then);
  // The results of a job, or what it was given, each a file here: the number of the first, or 0 with the
  // reason.
  void FromJob(const std::string& job, bool inputs,
               std::function<void(std::uint64_t, const std::string&)> then);
  std::vector<BroughtFile> Files();
  void Remove(std::uint64_t number);
  // The file of that number, as a form says it; empty: there is none.
  std::filesystem::path WhereIs(const std::string& number);

  // What `cairn pipelines --json` says, or why it says nothing.
  void Pipelines(std::function<void(const nlohmann::json&, const std::string& trouble)> then);
  // The plan of the first stage, as JSON.
  void Plan(const JobOrder& order, Said then);
  // The job as the coordinator has it, as JSON.
  void Submit(const JobOrder& order, Said then);

 private:
  friend class Upload;
  std::string WhyNoRoom(std::uint64_t announced, const std::string& whose) const;  // empty: there is
  bool Grow(std::uint64_t bytes);                                                  // false: there is no room
  void Shrink(std::uint64_t bytes);
  void LookAt(const BroughtFile& file, std::function<void()> then);
  std::string TakeOver(const std::string& job, const std::filesystem::path& folder,
                       std::vector<BroughtFile>* taken);
  std::string PathOf(std::uint64_t number);
  std::vector<std::string> WordsOf(const JobOrder& order, std::string* trouble);
  void Run(Errands* errands, Helper* helper, std::vector<std::string> words, Most most, const Said& then);

  DeskOptions options_;
  OwnFolder folder_;
  Helper inspects_, plans_, submits_;

  std::mutex mutex_;  // of all below
  std::vector<BroughtFile> files_;
  nlohmann::json pipelines_ = nullptr;
  std::uint64_t numbers_ = 0, bytes_ = 0;
  std::vector<std::string> uploads_;  // whose, of each that is under way

  Errands inspecting_{32}, planning_{32}, submitting_{32};  // the last to begin, the first to end
};

// The name that a file gets here, whatever it was called elsewhere.
std::string PlainName(const std::string& called);

}  // namespace cairn::page
