#include "datasets/bag/inspect_bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "datasets/bag/definition.h"
#include "datasets/bag/frames.h"
#include "datasets/bag/message_reader.h"
#include "datasets/bag/topics.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kMostFrames = 10;

// What is looked at in the messages of one channel.
struct Look {
  BagTopic* topic = nullptr;
  std::int64_t last_ns = 0;
  bool has_last = false;
  std::unique_ptr<bag::MessageReader> reader;  // none where its definition cannot be used
};

std::unique_ptr<bag::MessageReader> FrameReader(const bag::Channel& channel) {
  const std::string_view text =
      channel.definition.empty() ? bag::KnownDefinition(channel.type) : channel.definition;
  if (text.empty() || channel.wire == bag::Wire::kOther) return nullptr;
  return std::make_unique<bag::MessageReader>(
      bag::ParseDefinition(channel.type, text), channel.wire,
      std::vector<std::string>{"header.frame_id", "transforms.header.frame_id", "transforms.child_frame_id"});
}

void AddFrame(const std::string& frame, BagTopic* topic) {
  if (topic->frames.size() < kMostFrames && std::ranges::find(topic->frames, frame) == topic->frames.end())
    topic->frames.push_back(frame);
}

void LookAt(const bag::Message& message, Look* look, std::set<std::string>* remarks) {
  BagTopic& topic = *look->topic;
  if (look->has_last) {
    const double gap_s = bag::SecondsOf(message.receive_ns - look->last_ns);
    topic.gap_s = std::max(gap_s, topic.gap_s.value_or(gap_s));
  }
  look->has_last = true;
  look->last_ns = message.receive_ns;
  if (look->reader == nullptr || topic.frames.size() == kMostFrames) return;
  try {
    const std::vector<bag::Found>& found = look->reader->Read(message.bytes);
    for (const std::string_view frame : found[0].texts) AddFrame(bag::FrameName(frame), &topic);
    for (std::size_t i = 0; i < std::min(found[1].texts.size(), found[2].texts.size()); ++i)
      AddFrame(bag::FrameName(found[1].texts[i]) + " > " + bag::FrameName(found[2].texts[i]), &topic);
  } catch (const bag::Damage& damage) {
    remarks->insert(topic.name + ": " + damage.what);
  }
}

void LookThrough(bag::Container* file, std::vector<BagTopic>* topics, std::set<std::string>* remarks) {
  std::vector<Look> looks;
  std::vector<bool> wanted;
  std::size_t fields = 0;
  for (const bag::Channel& channel : file->channels()) {
    Look& look = looks.emplace_back();
    const auto topic = std::ranges::find_if(
        *topics, [&](const BagTopic& one) { return one.name == channel.topic && one.type == channel.type; });
    const bag::TypeUse* use = bag::FindUse(channel.type);
    wanted.push_back(use != nullptr && use->use != bag::Use::kCloud);  // most of a bag, where there are any
    look.topic = &*topic;
    if (!wanted.back()) continue;
    try {
      look.reader = FrameReader(channel);
      if (look.reader != nullptr)
        look.reader->CountFields(file->path(), &fields);
      else
        remarks->insert(channel.topic + ": the file does not say what its messages are made of");
    } catch (const bag::Damage& damage) {
      remarks->insert(channel.topic + ": " + damage.what);
    }
  }
  file->Read(
      wanted, [&](const bag::Message& message) { LookAt(message, &looks[message.channel], remarks); },
      [&](const std::string& what) { remarks->insert(file->path() + ": " + what); });
  for (const std::string& remark : file->remarks()) remarks->insert(file->path() + ": " + remark);
}

}  // namespace

BagInspection InspectBag(const std::string& path) {
  const bag::OpenedBags opened = bag::OpenBags(path);
  const auto& files = opened.files;
  BagInspection inspection;
  inspection.what = files.front()->what();
  inspection.files = files.size();
  std::int64_t first_ns = files.front()->first_ns(), last_ns = files.front()->last_ns();
  for (const auto& file : files) {
    first_ns = std::min(first_ns, file->first_ns());
    last_ns = std::max(last_ns, file->last_ns());
  }
  if (first_ns <= last_ns) {
    inspection.first_s = bag::SecondsOf(first_ns);
    inspection.length_s = bag::SecondsOf(last_ns) - inspection.first_s;
  }
  for (const bag::Topic& topic : bag::TopicsOf(files)) {
    BagTopic& one = inspection.topics.emplace_back();
    one.name = topic.name;
    one.type = topic.type;
    one.messages = topic.messages;
    if (topic.messages > 1 && inspection.length_s > 0)
      one.rate_hz = static_cast<double>(topic.messages) / inspection.length_s;
    if (topic.use != nullptr) one.as = topic.use->as;
  }
  std::set<std::string> remarks;
  for (const std::string& remark : opened.remarks) remarks.insert(path + ": " + remark);
  for (const std::string& name : opened.missing)
    remarks.insert(path + ": its metadata.yaml names " + name + ", and that is not there");
  for (const auto& file : files) LookThrough(file.get(), &inspection.topics, &remarks);
  inspection.remarks.assign(remarks.begin(), remarks.end());
  return inspection;
}

bool MakesALog(const BagInspection& inspection) {
  return std::ranges::any_of(inspection.topics, [](const BagTopic& topic) {
    return topic.as.starts_with("odometry") || topic.as == "where sensors sit";
  });
}

std::string BagText(const BagInspection& inspection) {
  std::string text = fmt::format("{}, {} topics over {:.1f} s from {:.3f} s\n", inspection.what,
                                 inspection.topics.size(), inspection.length_s, inspection.first_s);
  for (const BagTopic& topic : inspection.topics) {
    text += fmt::format("  {} {}: {} messages", Printable(topic.name, 200), Printable(topic.type, 200),
                        topic.messages);
    if (topic.rate_hz > 0) text += fmt::format(", {:.1f} Hz", topic.rate_hz);
    if (topic.gap_s) text += fmt::format(", longest gap {:.2f} s", *topic.gap_s);
    std::string frames;
    for (const std::string& frame : topic.frames)
      frames += (frames.empty() ? "" : ", ") + Printable(frame, 100);
    if (!frames.empty()) text += "; frame " + frames;
    text += topic.as.empty() ? "; not used\n" : "; as " + topic.as + "\n";
  }
  for (const std::string& remark : inspection.remarks) text += "  " + Printable(remark, 2000) + "\n";
  if (!MakesALog(inspection))
    return text + "  nothing in it says how a robot moved: no log can be made of it alone\n";
  return inspection.command.empty() ? text : text + "try: " + inspection.command + "\n";
}

}  // namespace cairn::datasets
