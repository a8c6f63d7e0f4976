// The worker's side of the conversation with a coordinator: Hello, heartbeats, fetches, answers. No threads,
// no clock and no sockets in here: events and the time go in, messages go out through the transport.
//
// A lost connection ends the conversation: the coordinator knows a worker by its connection, and gives the
// tasks of a lost one to others under new attempt numbers. So all tasks assigned are dropped; the cache
// stays, and with it the partials that the worker has made.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "worker/blob_cache.h"
#include "worker/peer_log.h"
#include "worker/shared_path.h"
#include "worker/task_queue.h"
#include "worker/transport.h"

namespace cairn::worker {

struct SessionOptions {
  wire::Hello hello;  // as it is sent
  std::size_t cache_bytes = 1u << 30;
  std::vector<wire::NamedBlob> given;  // that it has from the beginning, and need not fetch
  bool exit_on_leave = false;          // a private worker of one run; else it waits for the next coordinator
  // Says how its machine and its process are; may be empty.
  std::function<void(wire::Heartbeat*)> add_vitals = {};
  double first_contact_s = 0;  // give up where nobody has said Welcome by then; 0: never
  LogSink log = [](Severity, const std::string&) {};
};

inline constexpr int kExitDone = 0;
inline constexpr int kExitLost = 1;     // no coordinator in first_contact_s
inline constexpr int kExitRefused = 2;  // the coordinator does not want this worker

class Session {
 public:
  // `shared`: where it looks before it fetches; may be null.
  Session(SessionOptions options, Transport& transport, TaskQueue& queue, double now_s,
          SharedPath* shared = nullptr);
  void Handle(const Event& event, double now_s);
  // Fetches, answers and heartbeats that are due. Call it after events, after a wake-up, and after
  // WaitSeconds.
  void Work(double now_s);
  double WaitSeconds(double now_s) const;
  // Says that it wants no more tasks, finishes what it runs, sends Leave and ends with kExitDone; after
  // `patience_s` it ends in any case.
  void Leave(double patience_s, double now_s);
  void SendLeave();
  std::optional<int> exit_code() const { return exit_code_; }  // set: the conversation is over for good

 private:
  struct Request {
    Want want;
    double asked_s = 0;
    bool looked_for = false;  // in the shared folder: nobody is asked yet
  };
  void HandleMessage(const wire::Message& message, double now_s);
  void TakeBlob(const wire::BlobData& data, const wire::NamedBlob& named, double now_s);
  void TakeMissing(const wire::Missing& missing, double now_s);
  void HandleWelcome(const wire::Welcome& welcome, double now_s);
  void HandleAssign(const wire::Assign& assign, double now_s);
  void NoteFailedHandshake();
  void SayHello(double now_s);
  void DropConversation();
  void End(int code, Severity severity, const std::string& line);
  std::size_t Unsent(wire::Envelope::BodyCase kind) const;
  void TakeAnswers();
  BlobPtr Known(const Hash& hash);  // null: it has to be fetched
  bool Serve(const Want& want);     // from what is here; false: it has to be fetched
  void Fetch(double now_s);
  void TakeLooks(double now_s);
  void NoteArrivals(double now_s);
  void RepeatFetches(double now_s);
  void SendHeartbeat(double now_s);
  void EndIfLeft(double now_s);
  void Flush();

  const SessionOptions options_;
  Transport& transport_;
  TaskQueue& queue_;
  SharedPath* const shared_;
  PeerLog log_;
  BlobCache cache_;
  std::map<Hash, BlobPtr> given_;
  const double started_s_;
  bool connected_ = false;
  bool ever_welcome_ = false;
  unsigned failed_handshakes_ = 0;           // since it was last connected
  std::optional<double> heartbeat_s_;        // since Welcome
  double hello_s_ = 0;                       // when Hello was last said
  double heartbeat_sent_s_ = 0;              // when the last heartbeat went out
  bool leaving_ = false;                     // it ends once it has nothing assigned
  std::optional<double> leave_by_s_;         // of its own accord: then it ends in any case
  double blob_s_ = 0;                        // when a fetch was last answered, or some of an answer came
  std::optional<std::uint64_t> came_bytes_;  // of what has come, what was taken note of; none: nothing asked
  std::map<Hash, Request> requests_;         // of parts by their names
  std::deque<wire::Message> outbox_;
  std::optional<int> exit_code_;
};

}  // namespace cairn::worker
