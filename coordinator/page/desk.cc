#include "coordinator/page/desk.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

#include "schema/text.h"

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

constexpr double kMostPlanning_s = 600;
constexpr double kMostInspecting_s = 120;             // a file of 4 GB takes half a minute
constexpr double kMostSubmitting_s = 3600;            // the same, over a slow line
constexpr std::uint64_t kLeftFree_bytes = 256 << 20;  // of the disk

std::string NoRoom(std::uint64_t most_bytes) {
  return "There is room for " + BytesText(most_bytes) +
         " of files here in all: remove one that is not needed, or submit it with “cairn submit”.";
}

}  // namespace

std::string PlainName(const std::string& called) {
  constexpr std::size_t kMost = 80;
  std::string name = called.substr(called.find_last_of("/\\") + 1);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  name = name.substr(std::min(name.find_first_not_of(".-"), name.size()));
  if (name.size() > kMost) name = name.substr(name.size() - kMost);  // what kind it is stands at the end
  return name.empty() ? "file" : name;
}

std::string BroughtFile::Kind() const {
  const auto kind = content.is_object() ? content.find("kind") : content.end();
  return content.is_object() && kind != content.end() && kind->is_string() ? kind->get<std::string>() : "";
}

Upload::~Upload() {
  if (!kept_) Drop();
  if (fd_ >= 0) ::close(fd_);
  const std::lock_guard lock(desk_->mutex_);
  if (is_counted_) desk_->uploads_.erase(std::ranges::find(desk_->uploads_, whose_));
}

// What is left of it goes; what still comes is not kept.
void Upload::Drop() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  desk_->Shrink(std::exchange(bytes_, 0));
}

void Upload::Open(const std::string& called) {
  name_ = PlainName(called);
  std::error_code error;
  fs::create_directory(folder_, error);
  fd_ = ::open((folder_ / name_).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd_ < 0) trouble_ = "It cannot be kept here: " + std::string(std::strerror(errno)) + ".";
}

void Upload::Take(const std::string& field, const std::string& file, std::uint64_t at,
                  std::string_view bytes) {
  if (field != "file" || !trouble_.empty() || bytes.empty()) return;
  if (at != bytes_) {
    trouble_ = "Several files came as one: bring each on its own.";
    return Drop();
  }
  if (fd_ < 0 && !file.empty()) Open(file);
  if (fd_ < 0) return;
  if (!desk_->Grow(bytes.size())) {
    trouble_ = NoRoom(desk_->most_bytes());
    return Drop();
  }
  bytes_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      trouble_ = "It cannot be kept here: " + std::string(std::strerror(errno)) + ".";
      return Drop();
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

Desk::Desk(DeskOptions options)
    : options_(std::move(options)),
      folder_(options_.folder),
      inspects_(options_.program, folder_.path() / "inspects"),
      plans_(options_.program, folder_.path() / "plans"),
      submits_(options_.program, folder_.path() / "submits") {
  for (const char* name : {"inspects", "plans", "submits", "files"})
    fs::create_directory(folder_.path() / name);
}

Desk::~Desk() {
  inspects_.End();
  plans_.End();
  submits_.End();
  inspecting_.Stop();
  planning_.Stop();
  submitting_.Stop();
}

bool Desk::Grow(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes_ + bytes > options_.most_bytes) return false;
  bytes_ += bytes;
  return true;
}

void Desk::Shrink(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  bytes_ -= bytes;
}

std::string Desk::WhyNoRoom(std::uint64_t announced, const std::string& whose) const {
  if (uploads_.size() >= kMostUploads) return "Other uploads are under way: try again soon.";
  const auto own = static_cast<std::size_t>(std::ranges::count(uploads_, whose));
  const bool last_is_kept = own > 0 && uploads_.size() + 1 >= kMostUploads;  // for who has none
  if (own >= kMostUploadsOfOne || last_is_kept)
    return "Other uploads of yours are under way: try again when they have ended.";
  if (files_.size() >= kMostFiles) return "There are many files here already: remove one that is not needed.";
  if (announced > options_.most_bytes - bytes_) return NoRoom(options_.most_bytes);
  std::error_code error;
  const fs::space_info space = fs::space(folder_.path(), error);
  if (!error && space.available < announced + kLeftFree_bytes)
    return "The disk of the machine that “cairn page” runs on has too little room for it.";
  return "";
}

std::shared_ptr<Upload> Desk::Begin(std::uint64_t announced, const std::string& whose) {
  const std::lock_guard lock(mutex_);
  const std::string why = WhyNoRoom(announced, whose);
  if (why.empty()) uploads_.push_back(whose);
  return std::make_shared<Upload>(this, folder_.path() / "files" / std::to_string(++numbers_), whose, why);
}

void Desk::Keep(const std::shared_ptr<Upload>& upload,
                std::function<void(std::uint64_t, const std::string&)> then) {
  std::string trouble = upload->trouble_;
  if (trouble.empty() && upload->bytes_ == 0) trouble = "No file was chosen, or it is empty.";
  if (!trouble.empty()) return then(0, trouble);
  BroughtFile file{.number = 0, .name = upload->name_, .bytes = upload->bytes_};
  file.number = std::stoull(upload->folder_.filename().string());
  upload->kept_ = true;
  {
    const std::lock_guard lock(mutex_);
    files_.push_back(file);
  }
  LookAt(file, [number = file.number, then] { then(number, ""); });
}

void Desk::LookAt(const BroughtFile& file, std::function<void()> then) {
  Run(&inspecting_, &inspects_, {"inspect", "--json", "--", std::to_string(file.number) + "/" + file.name},
      {.time_s = kMostInspecting_s}, [this, number = file.number, then](const Helper::Outcome& said) {
        {
          const std::lock_guard lock(mutex_);
          const auto here = std::ranges::find(files_, number, &BroughtFile::number);
          if (here != files_.end()) {
            here->looked_at = true;
            here->content = nlohmann::json::parse(said.printed, nullptr, false);
            if (!here->content.is_object()) here->content = nullptr;
            here->trouble = said.trouble;
          }
        }
        then();
      });
}

// Into folders of their own, as files that people bring. A sentence where there is no room for all.
std::string Desk::TakeOver(const std::string& job, const fs::path& folder, std::vector<BroughtFile>* taken) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".h5") found.push_back(it->path());
  std::ranges::sort(found);
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const fs::path& file : found) bytes += fs::file_size(file, error);
  if (files_.size() + found.size() > kMostFiles)
    return "There are many files here already: remove one that is not needed.";
  if (bytes > options_.most_bytes - bytes_) return NoRoom(options_.most_bytes);
  for (const fs::path& file : found) {
    BroughtFile brought{.number = ++numbers_,
                        .name = PlainName(job + "-" + file.filename().string()),
                        .bytes = fs::file_size(file, error)};
    const fs::path own = folder_.path() / "files" / std::to_string(brought.number);
    fs::create_directory(own, error);
    if (!error) fs::rename(file, own / brought.name, error);
    if (error) return "It cannot be kept here: " + error.message() + ".";
    bytes_ += brought.bytes;
    files_.push_back(brought);
    taken->push_back(brought);
  }
  return "";
}

void Desk::FromJob(const std::string& job, bool inputs,
                   std::function<void(std::uint64_t, const std::string&)> then) {
  if (job.empty()) return then(0, "Say which job.");
  std::string folder, full;
  Most most{.time_s = kMostPlanning_s};
  {
    const std::lock_guard lock(mutex_);
    full = WhyNoRoom(0, "");
    folder = std::to_string(++numbers_);
    most.results_bytes = options_.most_bytes - bytes_;
  }
  if (!full.empty()) return then(0, full);
  most.results_in = folder_.path() / "files" / folder;
  std::vector<std::string> words = {"results", "--out=" + folder};
  if (inputs) words.emplace_back("--inputs");
  words.insert(words.end(), options_.service.begin(), options_.service.end());
  words.insert(words.end(), {"--", job});
  Run(&submitting_, &submits_, std::move(words), std::move(most),
      [this, job, folder, then](const Helper::Outcome& said) {
        std::vector<BroughtFile> taken;
        const fs::path from = folder_.path() / "files" / folder;
        std::string trouble = said.too_large ? NoRoom(options_.most_bytes) : said.trouble;
        if (trouble.empty()) trouble = TakeOver(job, from, &taken);
        std::error_code ignored;
        fs::remove_all(from, ignored);
        if (taken.empty()) return then(0, trouble.empty() ? "There is nothing of it to take." : trouble);
        for (std::size_t i = 0; i + 1 < taken.size(); ++i) LookAt(taken[i], [] {});
        LookAt(taken.back(), [number = taken.front().number, then] { then(number, ""); });
      });
}

std::vector<BroughtFile> Desk::Files() {
  const std::lock_guard lock(mutex_);
  return files_;
}

void Desk::Remove(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  const auto file = std::ranges::find(files_, number, &BroughtFile::number);
  if (file == files_.end()) return;
  std::error_code ignored;
  fs::remove_all(folder_.path() / "files" / std::to_string(number), ignored);
  bytes_ -= file->bytes;
  files_.erase(file);
}

std::filesystem::path Desk::WhereIs(const std::string& number) {
  const std::lock_guard lock(mutex_);
  for (const BroughtFile& file : files_)
    if (std::to_string(file.number) == number) return folder_.path() / "files" / number / file.name;
  return {};
}

void Desk::Run(Errands* errands, Helper* helper, std::vector<std::string> words, Most most,
               const Said& then) {
  const bool added = errands->Add([this, helper, words = std::move(words), most = std::move(most), then] {
    then(helper->Run(words, most, folder_.path() / "files"));
  });
  if (!added) then({.printed = "", .trouble = "too much waits already: try again soon"});
}

void Desk::Pipelines(std::function<void(const nlohmann::json&, const std::string&)> then) {
  nlohmann::json known;
  {
    const std::lock_guard lock(mutex_);
    known = pipelines_;
  }
  if (!known.is_null()) return then(known, "");
  Run(&planning_, &plans_, {"pipelines", "--json"}, {.time_s = kMostPlanning_s},
      [this, then](const Helper::Outcome& said) {
        const nlohmann::json told = nlohmann::json::parse(said.printed, nullptr, false);
        if (!told.is_array()) return then(nlohmann::json::array(), said.trouble);
        {
          const std::lock_guard lock(mutex_);
          pipelines_ = told;
        }
        then(told, "");
      });
}

// "3/hall.h5"; empty: there is no such file.
std::string Desk::PathOf(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  const auto file = std::ranges::find(files_, number, &BroughtFile::number);
  return file == files_.end() ? "" : std::to_string(number) + "/" + file->name;
}

// Each option and its value are one word, so that no value is taken for an option.
std::vector<std::string> Desk::WordsOf(const JobOrder& order, std::string* trouble) {
  const std::string path = PathOf(order.file);
  if (path.empty()) *trouble = "the file is not here any more: bring it again";
  std::vector<std::string> words = {"--json", "--seed=" + (order.seed.empty() ? "0" : order.seed)};
  if (!order.name.empty()) words.push_back("--name=" + order.name);
  for (const auto& [name, number] : order.inputs) {
    const std::string other = PathOf(number);
    if (other.empty()) *trouble = "the file for “" + name + "” is not here any more: bring it again";
    words.push_back("--input=" + name + "=" + other);
  }
  for (const auto& [name, value] : order.settings) words.push_back("--set=" + name + "=" + value);
  if (order.units_are_right) words.emplace_back("--units-are-right");
  words.insert(words.end(), {"--", order.pipeline, path});
  return words;
}

void Desk::Plan(const JobOrder& order, Said then) {
  std::string trouble;
  std::vector<std::string> words = WordsOf(order, &trouble);
  if (!trouble.empty()) return then({.printed = "", .trouble = trouble});
  words.insert(words.begin(), {"run", "--dry-run"});
  Run(&planning_, &plans_, std::move(words), {.time_s = kMostPlanning_s}, then);
}

void Desk::Submit(const JobOrder& order, Said then) {
  std::string trouble;
  std::vector<std::string> words = WordsOf(order, &trouble);
  if (!trouble.empty()) return then({.printed = "", .trouble = trouble});
  words.insert(words.begin(), options_.service.begin(), options_.service.end());
  if (!order.priority.empty()) words.insert(words.begin(), "--priority=" + order.priority);
  words.insert(words.begin(), "submit");
  Run(&submitting_, &submits_, std::move(words), {.time_s = kMostSubmitting_s}, then);
}

}  // namespace cairn::page
