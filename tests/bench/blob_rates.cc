#include "tests/bench/blob_rates.h"

#include <sodium.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"
#include "tests/bench/exchange.h"

namespace cairn::bench {
namespace {

constexpr std::size_t kBlobBytes = std::size_t{16} << 20;
constexpr int kBlobs = 40;
constexpr int kInFlight = 4;
constexpr int kTurns = 5;

// Bytes a second, with at most kInFlight blobs on their way.
double BytesPerSecond(Awaited& words, const std::function<void()>& send, const std::function<void()>& take) {
  send(), take();
  return Rate(words, kBlobs, kInFlight, send, take) * static_cast<double>(kBlobBytes);
}

std::vector<double> Numbers() { return std::vector<double>(kBlobBytes / sizeof(double), 1.5); }

// Bare ZeroMQ, one thread for I/O on each side, frames sent without a copy; each blob is answered by a word.
double BareRate(bool curve) {
  Awaited words(curve ? "bare ZeroMQ's word for a blob over TCP, with CURVE"
                      : "bare ZeroMQ's word for a blob over TCP");
  const wire::KeyPair server = wire::GenerateKeyPair(), client = wire::GenerateKeyPair();
  zmq::context_t here, there;
  zmq::socket_t sender(here, zmq::socket_type::dealer), receiver(there, zmq::socket_type::dealer);
  if (curve) {
    sender.set(zmq::sockopt::curve_server, true);
    sender.set(zmq::sockopt::curve_secretkey, server.secret_key);
    receiver.set(zmq::sockopt::curve_serverkey, server.public_key);
    receiver.set(zmq::sockopt::curve_publickey, client.public_key);
    receiver.set(zmq::sockopt::curve_secretkey, client.secret_key);
  }
  sender.bind("tcp://127.0.0.1:*");
  receiver.connect(sender.get(zmq::sockopt::last_endpoint));
  std::thread other([&receiver] {
    zmq::message_t message;
    while (receiver.recv(message) && message.size() > 1)
      receiver.send(zmq::str_buffer("ok"), zmq::send_flags::none);
  });
  const std::vector<double> data = Numbers();
  const auto send = [&] {
    zmq::message_t message(const_cast<double*>(data.data()), kBlobBytes, [](void*, void*) {});
    sender.send(message, zmq::send_flags::none);
  };
  const auto take = [&] {
    zmq::message_t message;
    if (!sender.recv(message)) std::abort();
  };
  const double rate = BytesPerSecond(words, send, take);
  sender.send(zmq::str_buffer("."), zmq::send_flags::none);
  other.join();
  return rate;
}

// A peer that takes blobs as a worker does: decoded into aligned memory, each checked against its hash.
void TakeBlobs(wire::DealerSocket dealer) {
  wire::Poller poller;
  poller.Add(dealer);
  wire::Message word;
  word.envelope.mutable_leave();
  SendOver(dealer, poller, word);
  while (true) {
    TakeEvents(dealer);
    while (std::optional<wire::Received> received = dealer.TryReceive()) {
      CAIRN_DEMAND(received->status.ok(), received->status.message());
      if (!received->message.envelope.has_blob()) return;
      SendOver(dealer, poller, word);
    }
    poller.Wait(std::chrono::seconds(10));
  }
}

double WireRate() {
  Awaited words("the word for a blob over schema/wire, with CURVE");
  const wire::PrivateFolder folder;
  const wire::KeyPair server = wire::GenerateKeyPair(), client = wire::GenerateKeyPair();
  std::ofstream(folder.path() / "allowed") << client.public_key << " worker\nend\n";
  wire::Context here;
  wire::RouterSocket router =
      wire::RouterSocket::Bind(here, "tcp://127.0.0.1:*",
                               wire::ServerSecurity{server, folder.path() / "allowed"})
          .value();
  const wire::Context there;
  std::thread other(TakeBlobs, wire::DealerSocket::Connect(there, router.endpoint(),
                                                           wire::ClientSecurity{client, server.public_key})
                                   .value());
  wire::Poller poller;
  poller.Add(router);
  const auto take = [&] {
    while (true) {
      if (const std::optional<wire::Received> received = router.TryReceive()) {
        CAIRN_DEMAND(received->status.ok(), received->status.message());
        return received->peer;
      }
      poller.Wait(std::chrono::seconds(10));
    }
  };
  const std::string peer = take();
  Blob blob;
  blob.PutVector("v", Numbers());
  wire::Message message;
  message.envelope.mutable_blob();
  message.blobs = {wire::NameBlob(std::make_shared<const Blob>(std::move(blob)))};
  const auto send = [&] { CAIRN_DEMAND(router.Send(peer, message).ok(), "not sent"); };
  const double rate = BytesPerSecond(words, send, [&] { take(); });
  message.envelope.mutable_leave();
  message.blobs.clear();
  CAIRN_DEMAND(router.Send(peer, message).ok(), "not sent");
  other.join();
  return rate;
}

// What one core does with the same bytes.
double OnOneCore(const std::function<void()>& work) {
  work();
  return 10 * static_cast<double>(kBlobBytes) / Seconds([&] {
           for (int i = 0; i < 10; ++i) work();
         });
}

double CopyRate() {
  const std::vector<double> from = Numbers();
  std::vector<double> to(from.size());
  return OnOneCore([&] {
    std::memcpy(to.data(), from.data(), kBlobBytes);
    asm volatile("" : : "r"(to.data()) : "memory");
  });
}

// CURVE's: XSalsa20 and Poly1305.
double BoxRate() {
  const std::vector<double> from = Numbers();
  std::vector<unsigned char> to(kBlobBytes + crypto_box_MACBYTES);
  const std::vector<unsigned char> key(crypto_box_BEFORENMBYTES, 1), nonce(crypto_box_NONCEBYTES, 2);
  return OnOneCore([&] {
    crypto_box_easy_afternm(to.data(), reinterpret_cast<const unsigned char*>(from.data()), kBlobBytes,
                            nonce.data(), key.data());
  });
}

double HashRate() {
  Blob blob;
  blob.PutVector("v", Numbers());
  Hash hash;
  return OnOneCore([&] { hash = blob.ContentHash(); });
}

struct Line {
  const char* what;
  std::function<double()> measure;
  double best = 0;
};

}  // namespace

void PrintBlobRates() {
  CAIRN_DEMAND(sodium_init() >= 0, "libsodium does not start");
  std::vector<Line> lines = {
      {"memcpy, one core", CopyRate},
      {"XXH3-128 of a blob, one core", HashRate},
      {"XSalsa20-Poly1305, one core", BoxRate},
      {"bare ZeroMQ, plain", [] { return BareRate(false); }},
      {"bare ZeroMQ, CURVE", [] { return BareRate(true); }},
      {"schema/wire, CURVE, hash-checked", WireRate},
  };
  // In turns, the best of each: other work on the machine only ever slows things down.
  for (int turn = 0; turn < kTurns; ++turn)
    for (Line& line : lines) line.best = std::max(line.best, line.measure());
  std::printf("\nblobs of 16 MB over tcp on loopback; in brackets: ratio to XSalsa20-Poly1305 on one core\n");
  for (const Line& line : lines)
    std::printf("%-34s %6.2f GB/s (%4.2f)\n", line.what, line.best / 1e9, line.best / lines[2].best);
}

}  // namespace cairn::bench
