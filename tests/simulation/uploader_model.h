// Clients that bring the inputs of their jobs in pieces (coordinator/core/uploads.h) and then hand them in:
// one for each submission, over a connection of its own, which keeps the order. They are killed, stand still,
// and cheat.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "coordinator/core/events.h"
#include "coordinator/core/uploads.h"

namespace cairn::simulation {

class World;

// So small that any two clients meet its limits.
inline constexpr coordinator::UploadOptions kUploads = {.piece_bytes = 1,
                                                        .window_bytes = 4,
                                                        .total_bytes = 6,
                                                        .places = 2,
                                                        .waiting = 100,
                                                        .silent_s = 10,
                                                        .told_s = 1};

class UploaderModel {
 public:
  explicit UploaderModel(World& world) : world_(world) {}

  // Its blobs are those that it brings.
  void Begin(const coordinator::SubmitJob& event);
  void Hear(const std::string& peer, const wire::Credit& credit);
  void Hear(const coordinator::AnswerOffer& answer);
  // Its connection is gone: the coordinator's doing, or its end.
  void Drop(const std::string& peer) { clients_.erase(peer); }
  void DropAll() { clients_.clear(); }
  bool IsThere(const std::string& peer) const { return clients_.contains(peer); }
  // Every second: nobody waits for ever.
  void CheckThatTheyMove();

 private:
  struct Client {
    coordinator::SubmitJob event;
    std::uint64_t bytes = 0, sent = 0,
                  credit = 0;  // of the blob that is under way, the last of `event.blobs`
    std::vector<Hash> left;    // still to be brought
    double delay_s = 0, heard_s = 0, stopped_until_s = 0;
    bool cheats = false;
    bool sending = false;
  };
  void Offer(const std::string& peer);
  void Send(const std::string& peer);

  World& world_;
  std::map<std::string, Client> clients_;
  std::uint64_t next_ = 0;
  double began_s_ = 0;  // the latest of them
};

}  // namespace cairn::simulation
