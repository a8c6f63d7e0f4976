// What a worker logs of its coordinator, at a rate and a length with which no coordinator fills a disk.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace cairn::worker {

enum class Severity { kInfo, kWarning, kError };
using LogSink = std::function<void(Severity, const std::string& line)>;

class PeerLog {
 public:
  enum Topic { kLink, kMalformed, kWelcome, kRefusal, kDrain, kEnd, kShared, kStray, kTask };
  explicit PeerLog(LogSink sink) : sink_(std::move(sink)) {}
  // The first line of a topic at once; those that follow within kQuiet_s are counted, and told with the next.
  // A line is cut at 4,096 bytes.
  void Say(Topic topic, Severity severity, const std::string& line, double now_s);

 private:
  static constexpr double kQuiet_s = 5;
  struct Told {
    double at_s = 0;
    std::uint64_t untold = 0;
  };
  LogSink sink_;
  std::map<Topic, Told> topics_;
};

}  // namespace cairn::worker
