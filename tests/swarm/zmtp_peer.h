// One side of a ZeroMQ connection without ZeroMQ: what a worker's DEALER says and hears
// (rfc.zeromq.org/spec/23, with keys spec/26), over one descriptor and in a few KiB, so that one process can
// be thousands of workers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::swarm {

using Key = std::array<unsigned char, 32>;

struct PeerKeys {
  Key server_public{}, own_public{}, own_secret{};
};

class ZmtpPeer {
 public:
  // Begins to connect to ipc://PATH or tcp://ADDRESS:PORT; to the latter from the address `from` of this
  // machine where it says one. `keys`: of a server that has keys; must outlive it.
  ZmtpPeer(const std::string& endpoint, const std::string& from, const PeerKeys* keys);
  ZmtpPeer(const ZmtpPeer&) = delete;
  ZmtpPeer& operator=(const ZmtpPeer&) = delete;
  ~ZmtpPeer();

  int fd() const { return fd_; }  // -1: it could not even begin
  bool Ready() const { return state_ == State::kReady; }
  bool WantsToWrite() const { return connecting_ || !out_.empty(); }
  // After the descriptor could be read or written. What came in whole since the last call, a list of frames
  // each. False: the connection is over.
  bool Turn(std::vector<std::vector<std::string>>* messages);
  // Queues them; the next Flush, or Turn, sends.
  void Send(const std::vector<std::string_view>& frames);
  void Ping();
  bool Flush();
  std::uint64_t bytes_in() const { return bytes_in_; }
  std::uint64_t bytes_out() const { return bytes_out_; }

 private:
  enum class State { kGreeting, kWelcome, kReadyCommand, kReady };

  void Greet();
  bool Read();
  bool TakeGreeting();
  std::optional<std::string> NextFrame(unsigned char* flags);
  bool TakeFrame(unsigned char flags, std::string frame, std::vector<std::vector<std::string>>* messages);
  bool TakeHandshake(std::string_view frame);
  bool Open(std::string* frame, unsigned char* flags);
  void PutFrame(unsigned char flags, std::string_view body);
  void PutOpen(unsigned char flags, std::string_view body);
  void SayHello();
  bool TakeWelcome(std::string_view body);
  std::string NextNonce(std::string_view prefix, std::string* short_nonce);

  int fd_ = -1;
  const PeerKeys* keys_;
  bool connecting_ = true;
  State state_ = State::kGreeting;
  std::string in_, out_;
  std::size_t taken_ = 0;  // of in_
  std::vector<std::string> frames_;
  std::uint64_t nonce_ = 0;
  Key ephemeral_public_{}, ephemeral_secret_{}, shared_{};
  std::uint64_t bytes_in_ = 0, bytes_out_ = 0;
};

}  // namespace cairn::swarm
