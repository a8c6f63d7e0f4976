#include "datasets/bag/import_bag.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <set>
#include <utility>

#include "datasets/bag/choose_topics.h"
#include "datasets/bag/container.h"
#include "datasets/bag/definition.h"
#include "datasets/bag/place_sensors.h"
#include "datasets/bag/readers.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

using bag::Topic;
using bag::Use;

// What to do with a message, or a part of a file, that cannot be used: stop, or skip and count.
class BadMessages {
 public:
  explicit BadMessages(bool skips) : skips_(skips) {}
  void Add(const std::string& where, const LineError& error) {
    if (!skips_)
      throw InputError(where + ": " + error.reason +
                       (error.detail.empty() ? "" : ": " + Excerpt(error.detail)) +
                       " (--skip-bad skips such messages and counts them)");
    ++counts_[error.reason];
    ++skipped_;
  }
  std::int64_t skipped() const { return skipped_; }
  std::string Reasons() const {
    std::string reasons;
    for (const auto& [reason, count] : counts_)
      reasons += (reasons.empty() ? "" : ", ") + reason + " (" + std::to_string(count) + ")";
    return reasons;
  }
  const std::map<std::string, std::int64_t>& counts() const { return counts_; }

 private:
  bool skips_;
  std::int64_t skipped_ = 0;
  std::map<std::string, std::int64_t> counts_;
};

// A topic that is read: by whom, and how far it has come.
struct TopicInHand {
  std::string name, type;
  std::unique_ptr<bag::TopicReader> reader;
  bag::TopicClock clock;
  std::int64_t taken = 0;
  const bag::Container* from = nullptr;  // the last that was taken
};

// One channel of one file: its messages, decoded.
struct ChannelInHand {
  TopicInHand* topic = nullptr;
  std::unique_ptr<bag::MessageReader> reader;
};

class BagImport {
 public:
  explicit BagImport(const BagImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* log) {
    CheckNoise(options_.noise);
    Gather();
    WarnOfClocks();
    try {
      ImportReport made = bag::MakeBagLog(std::move(robots_), std::move(report_), log);
      made.skipped = bad_.counts();
      return made;
    } catch (const InputError& error) {  // of what was left out it may be the consequence
      std::string why = error.what();
      if (bad_.skipped() > 0) why += " (skipped: " + bad_.Reasons() + ")";
      if (missing_ > 0) why += " (" + std::to_string(missing_) + " messages are counted in it and not found)";
      if (options_.from_s || options_.until_s) why += " (of what lies between --from and --until)";
      throw InputError(why);
    }
  }

 private:
  void Gather() {
    for (const std::string& path : options_.files) Open(path);
    std::ranges::stable_sort(bags_, {}, [](const auto& one) { return one->first_ns(); });
    topics_ = bag::TopicsOf(bags_);
    if (topics_.empty()) RefuseWithoutTopics();
    CheckMounts();
    SetClock();
    if (!options_.cloud.empty()) FindMounts();
    ChooseTopics();
    for (const auto& one : bags_) ReadBag(one.get());
    CheckSkipped();
    for (bag::Gathered& robot : robots_) {
      for (const auto& camera : robot.cameras) camera->Finish(&report_);
      robot.noise = options_.noise;
      robot.mounts = options_.mounts;
      robot.path = bags_.size() == 1 ? bags_.front()->path() : options_.files.front() + " and others";
    }
  }

  // Frames may turn up in the midst of a bag; topics are known.
  void CheckMounts() const {
    for (const auto& [name, pose] : options_.mounts)
      if (name.starts_with('/') &&
          std::ranges::none_of(topics_, [&](const Topic& topic) { return topic.name.ends_with(name); }))
        bag::FindTopic(topics_, name, {}, "--mount");
  }

  void Open(const std::string& path) {
    bag::OpenedBags opened = bag::OpenBags(path);
    if (!opened.missing.empty())
      throw InputError("'" + path + "': its metadata.yaml names " +
                       fmt::format("{}", fmt::join(opened.missing, ", ")) +
                       ", and that is not there: a part of the recording is missing. Put it there, or go on "
                       "without: name the "
                       "files one by one, '" +
                       opened.files.front()->path() + "' first");
    for (const std::string& remark : opened.remarks) report_.warnings.push_back(path + ": " + remark);
    std::ranges::move(opened.files, std::back_inserter(bags_));
  }

  // What is wrong with the files is said before what could be chosen of them.
  [[noreturn]] void RefuseWithoutTopics() {
    for (const auto& one : bags_) ReadBag(one.get());
    CheckSkipped();
    throw InputError(options_.files.front() + ": there is no topic in it");
  }

  // Where a cloud's sensor sits must be known before its points are looked at: poses and frames are read
  // first.
  void FindMounts() {
    BagImportOptions places = options_;
    places.scans = places.sonars = {"none"};
    places.landmarks.clear();
    places.tags.clear();
    places.cloud.clear();
    BagImport first(places);
    first.Gather();
    for (bag::Gathered& robot : first.robots_) mounts_.push_back(bag::MountsOf(std::move(robot)));
  }

  void SetClock() {
    clock_.by_receipt = options_.by_receipt;
    // Of times as the log has them none is so small, of drives none so long.
    constexpr double kLeastTime_s = 1e8;
    const double first_s = bags_.empty() ? 0 : bag::SecondsOf(bags_.front()->first_ns());
    const auto time = [&](double given_s) { return given_s < kLeastTime_s ? first_s + given_s : given_s; };
    if (options_.from_s) clock_.from_s = time(*options_.from_s);
    if (options_.until_s) clock_.until_s = time(*options_.until_s);
    if (clock_.from_s > clock_.until_s)
      throw InputError("--from is later than --until: there is no time between them");
  }

  void Add(const Topic& topic, std::unique_ptr<bag::TopicReader> reader) {
    for (const TopicInHand& other : in_hand_)
      if (other.name == topic.name && other.type == topic.type)
        throw InputError("the topic " + topic.name + " is named twice");
    in_hand_.push_back({topic.name, topic.type, std::move(reader), bag::TopicClock(clock_)});
  }

  void ChooseTopics() {
    const std::vector<std::string> names = bag::RobotsOf(options_, topics_);
    robots_.resize(std::max<std::size_t>(names.size(), 1));  // readers point into it
    in_hand_.reserve(topics_.size());                        // channels point into it
    std::vector<bag::TransformsOf> all;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      bag::Gathered& robot = robots_[i];
      if (!names.empty()) robot.robot = names[i];
      robot.KeepIn(options_.folder);
      robot.topics = bag::TopicsOfRobot(topics_, names, robot.robot);
      if (!mounts_.empty()) robot.find_mount = mounts_[i];
      const auto add = [&](const Topic& topic, std::unique_ptr<bag::TopicReader> reader) {
        Add(topic, std::move(reader));
      };
      bag::ChooseTopics(bag::OptionsOfRobot(options_, names, robot), bags_, &robot, add);
      all.push_back({&robot.frames, &robot.followed});
    }
    for (const Topic& topic : topics_) {
      if (topic.use == nullptr || topic.use->use != Use::kTransforms) continue;
      std::vector<bag::TransformsOf> takers;
      for (std::size_t i = 0; i < robots_.size(); ++i)
        if (bag::HasTopic(robots_[i].topics, topic.name)) takers.push_back(all[i]);
      Add(topic, bag::ReadTransforms(topic.name.ends_with("tf_static"), takers));
    }
  }

  // Readers of a file's channels; of those that are not wanted none.
  std::vector<ChannelInHand> ReadersOf(const bag::Container& file) {
    std::vector<ChannelInHand> readers;
    std::size_t fields = 0;
    for (const bag::Channel& channel : file.channels()) {
      ChannelInHand& reader = readers.emplace_back();
      const auto topic = std::ranges::find_if(in_hand_, [&](const TopicInHand& one) {
        return one.name == channel.topic && one.type == channel.type;
      });
      if (topic == in_hand_.end()) continue;
      try {
        reader.reader = ReaderOf(channel, *topic->reader);
        reader.reader->CountFields(file.path(), &fields);
        reader.topic = &*topic;
      } catch (const bag::Damage& damage) {
        if (topic->reader->is_aside()) continue;
        bad_.Add(file.path() + ": " + channel.topic, {"a definition that cannot be used", damage.what});
      }
    }
    return readers;
  }

  static std::unique_ptr<bag::MessageReader> ReaderOf(const bag::Channel& channel,
                                                      const bag::TopicReader& topic) {
    if (channel.wire == bag::Wire::kOther)
      throw bag::Damage{"messages encoded as '" + Printable(channel.encoding, 40) +
                        "'; known are ros1 and cdr"};
    const std::string_view text = bag::DefinitionOf(channel);
    if (text.empty())
      throw bag::Damage{"the file does not say what a " + channel.type +
                        " is made of, as those of ROS 2 before Iron do not, and Cairn does not know it"};
    const std::vector<std::string> paths = topic.paths();
    const bag::Definition definition = bag::ParseDefinition(channel.type, text);
    auto reader = std::make_unique<bag::MessageReader>(definition, channel.wire, paths);
    for (std::size_t i = 0; i < topic.needed(); ++i) {
      if (reader->Has(i)) continue;
      const std::string missing = "its " + channel.type + " has no field '" + paths[i] + "'";
      if (!topic.fields_are_named()) throw bag::Damage{missing};
      throw InputError(channel.topic + ": " + missing +
                       "; the nearest: " + bag::NearestNames(bag::FieldPaths(definition), paths[i]));
    }
    return reader;
  }

  void ReadBag(bag::Container* one) {
    std::vector<ChannelInHand> readers = ReadersOf(*one);
    std::vector<bool> wanted;
    for (const ChannelInHand& reader : readers) wanted.push_back(reader.topic != nullptr);
    const auto take = [&](const bag::Message& message) {
      TakeMessage(*one, &readers[message.channel], message);
    };
    const std::vector<std::uint64_t> found = one->Read(wanted, take, [&](const std::string& what) {
      bad_.Add(one->path() + ": " + LastMessage(), {"part of a file that cannot be read", what});
    });
    for (const std::string& remark : one->remarks()) report_.warnings.push_back(one->path() + ": " + remark);
    for (std::size_t i = 0; i < found.size(); ++i)
      if (wanted[i] && !readers[i].topic->reader->is_aside() && found[i] < one->channels()[i].messages)
        missing_ += static_cast<std::int64_t>(one->channels()[i].messages - found[i]);
  }

  std::string LastMessage() const {
    if (last_topic_ == nullptr) return "before the first message";
    return "after message " + std::to_string(last_number_) + " of " + last_topic_->name;
  }

  void TakeMessage(const bag::Container& one, ChannelInHand* channel, const bag::Message& message) {
    TopicInHand& topic = *channel->topic;
    last_topic_ = &topic;
    last_number_ = message.number;
    try {
      topic.reader->Take(channel->reader->Read(message.bytes), message, &topic.clock);
      ++topic.taken;
      topic.from = &one;
    } catch (const bag::Damage& damage) {
      BadMessage(one, topic, message, {"a message that does not match its definition", damage.what});
    } catch (LineError error) {
      if (error.reason == bag::kRunsBackwards && topic.from != nullptr && topic.from != &one)
        error.detail += ", to which " + topic.from->path() +
                        " goes: the bags overlap, and --skip-bad takes what both hold from that one alone; "
                        "bags of several robots are a log each";
      BadMessage(one, topic, message, error);
    }
  }

  void BadMessage(const bag::Container& one, const TopicInHand& topic, const bag::Message& message,
                  const LineError& error) {
    if (topic.reader->is_aside()) return;
    bad_.Add(one.path() + ": message " + std::to_string(message.number) + " of " + topic.name, error);
  }

  // What --skip-bad leaves of a file is seldom what its maker meant, where it is less than half.
  void CheckSkipped() {
    std::int64_t taken = 0;
    for (const TopicInHand& topic : in_hand_) {
      if (topic.reader->is_aside()) continue;
      taken += topic.taken;
      if (topic.taken > 0) report_.read["messages of " + topic.name] = topic.taken;
    }
    const std::int64_t lost = bad_.skipped() == 0 ? 0 : bad_.skipped() + missing_;
    if (lost <= taken) return;
    throw InputError(options_.files.front() + ": --skip-bad leaves " + std::to_string(taken) + " of " +
                     std::to_string(taken + lost) + " messages, less than half; skipped: " + bad_.Reasons() +
                     ". Without --skip-bad the first such message is named");
  }

  // Topics whose headers were written by other clocks than the odometry's.
  void WarnOfClocks() {
    constexpr double kMostApart_s = 0.1;
    if (options_.by_receipt || in_hand_.empty()) return;
    const auto first =
        std::ranges::find_if(in_hand_, [](const auto& t) { return t.clock.least_delay_s().has_value(); });
    if (first == in_hand_.end()) return;
    for (const TopicInHand& topic : in_hand_) {
      if (!topic.clock.least_delay_s() || topic.reader->is_aside()) continue;
      const double apart_s = *topic.clock.least_delay_s() - *first->clock.least_delay_s();
      if (std::abs(apart_s) <= kMostApart_s) continue;
      report_.warnings.push_back(topic.name + ": the clock of its headers is " +
                                 std::to_string(std::abs(apart_s)) + " s " +
                                 (apart_s > 0 ? "behind" : "ahead of") + " that of " + first->name +
                                 ", by when the recorder had their messages; --by-receipt takes its times");
    }
  }

  const BagImportOptions& options_;
  BadMessages bad_;
  ImportReport report_;
  std::vector<std::unique_ptr<bag::Container>> bags_;
  std::vector<Topic> topics_;
  bag::ClockOptions clock_;
  std::vector<TopicInHand> in_hand_;
  std::vector<bag::Gathered> robots_;
  std::vector<bag::FindMount> mounts_;  // of each robot, where clouds need them
  const TopicInHand* last_topic_ = nullptr;
  std::uint64_t last_number_ = 0;
  std::int64_t missing_ = 0;  // messages that files count, and that could not be found in them
};

}  // namespace

ImportReport ImportBag(const BagImportOptions& options, Blob* log) { return BagImport(options).Run(log); }

}  // namespace cairn::datasets
