#include "datasets/bag/container.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "datasets/bag/definition.h"
#include "datasets/import/recognize.h"
#include "schema/error.h"

namespace cairn::datasets::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kZstd = "\x28\xB5\x2F\xFD";
constexpr std::size_t kMostChannels = 10'000, kMostKept = 64 << 20;

std::string HeadOf(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  std::array<char, 16> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return {head.data(), static_cast<std::size_t>(file.gcount())};
}

bool IsBagFile(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".db3" || ending == ".mcap";
}

}  // namespace

void Container::CountText(std::size_t bytes) {
  text_bytes_ += bytes;
  if (text_bytes_ > kMostKept)
    throw InputError(path_ + ": names of topics and definitions of their types of more than 64 MiB in all");
}

std::string_view Container::Keep(std::string_view text) {
  if (text.empty()) return {};
  if (text.size() > kMostDefinitionBytes) throw InputError(path_ + ": a definition of more than a megabyte");
  auto kept = texts_.find(text);
  if (kept == texts_.end()) {
    CountText(text.size());
    kept = texts_.emplace(text).first;
  }
  return *kept;
}

std::size_t Container::FindOrAdd(Channel channel) {
  const auto found = std::ranges::find_if(channels_, [&](const Channel& other) {
    return other.topic == channel.topic && other.type == channel.type &&
           other.definition.data() == channel.definition.data() && other.encoding == channel.encoding;
  });
  if (found != channels_.end()) return static_cast<std::size_t>(found - channels_.begin());
  if (channels_.size() == kMostChannels) throw Damage{"more than 10,000 topics"};
  CountText(channel.topic.size() + channel.type.size() + channel.encoding.size());
  channels_.push_back(std::move(channel));
  return channels_.size() - 1;
}

std::vector<std::uint64_t> Container::Read(const std::vector<bool>& wanted, const Take& take,
                                           const Broken& broken) {
  std::vector<std::uint64_t> found(channels_.size());
  ReadMessages(
      wanted,
      [&](Message message) {
        message.number = ++found[message.channel];
        take(message);
      },
      broken);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (wanted[i] && found[i] != channels_[i].messages)
      remarks_.push_back(std::to_string(channels_[i].messages) + " messages of " + channels_[i].topic +
                         " are counted in it, and " + std::to_string(found[i]) + " were found");
  return found;
}

void Container::Cover(std::int64_t first_ns, std::int64_t last_ns) {
  first_ns_ = std::min(first_ns_, first_ns);
  last_ns_ = std::max(last_ns_, last_ns);
}

void Container::ForgetChannels() {
  channels_.clear();
  texts_.clear();
  text_bytes_ = 0;
  remarks_.clear();
  first_ns_ = std::numeric_limits<std::int64_t>::max();
  last_ns_ = std::numeric_limits<std::int64_t>::min();
}

std::unique_ptr<Container> OpenContainer(const std::string& path) {
  const std::string head = HeadOf(path);
  try {
    if (BagName(head) == "a ROS 1 bag") return OpenRos1Bag(path);
    if (BagName(head) == "an MCAP file") return OpenMcap(path);
    if (BagName(head)) return OpenSqliteBag(path);
  } catch (const Damage& damage) {
    throw InputError(path + ": " + damage.what);
  }
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError("'" + path + "': there is no such file");
  if (head.starts_with(kZstd))
    throw InputError(path + ": packed as a whole; unpack it first: unzstd '" + path + "'");
  throw InputError(path +
                   ": no bag: neither of ROS 1 ('#ROSBAG V2.0'), nor MCAP, nor an SQLite file of rosbag2");
}

std::vector<std::string> BagFilesOf(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<std::string> files;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error))
    if (IsBagFile(entry->path())) files.push_back(entry->path().string());
  if (files.empty()) throw InputError("'" + path + "': a folder without bags of rosbag2 (.db3, .mcap) in it");
  // bag_2 before bag_10.
  std::ranges::sort(files, [](const std::string& a, const std::string& b) {
    return std::pair(a.size(), a) < std::pair(b.size(), b);
  });
  return files;
}

double SecondsOf(std::int64_t ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t whole_s = ns / kSecond_ns;
  return static_cast<double>(whole_s) + 1e-9 * static_cast<double>(ns - whole_s * kSecond_ns);
}

std::string TypeName(std::string type) {
  constexpr std::string_view kMiddle = "/msg/";
  if (const std::size_t at = type.find(kMiddle); at != std::string::npos)
    type.replace(at, kMiddle.size(), "/");
  return type;
}

}  // namespace cairn::datasets::bag
