// What the transport and the worker cost on ipc, as ratios to bare ZeroMQ doing the same in the same run:
// figures of one machine say little, ratios carry over. Not run by ctest:
//
//   cmake --build --preset release --target wire_bench && build/release/tests/bench/wire_bench
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <zmq.hpp>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/private_folder.h"
#include "tests/bench/blob_rates.h"
#include "tests/bench/exchange.h"
#include "worker/worker.h"
#include "worker/zmq_transport.h"

namespace cairn::bench {
namespace {

constexpr int kRoundTrips = 20'000;
constexpr int kStreamed = 200'000;
constexpr int kInFlight = 64;
constexpr int kBlobs = 60;
constexpr std::size_t kBlobBytes = std::size_t{16} << 20;

// ---- bare ZeroMQ: an echo in another thread ----
class BareEcho {
 public:
  explicit BareEcho(const std::string& endpoint)
      : peer_(context_, zmq::socket_type::dealer), router_(context_, zmq::socket_type::router) {
    router_.set(zmq::sockopt::sndhwm, 0);
    router_.set(zmq::sockopt::rcvhwm, 0);
    peer_.set(zmq::sockopt::linger, 0);
    router_.bind(endpoint);
    peer_.connect(endpoint);
    echo_ = std::thread([this] {
      zmq::message_t message;
      while (peer_.recv(message) && !message.empty()) {
        if (message.size() < 1000)
          peer_.send(message, zmq::send_flags::none);
        else
          peer_.send(zmq::str_buffer("ok"), zmq::send_flags::none);
      }
    });
    Take(nullptr);
  }
  ~BareEcho() {
    Ask(zmq::message_t());
    echo_.join();
  }
  void Ask(zmq::message_t message) {
    router_.send(zmq::buffer(id_), zmq::send_flags::sndmore);
    router_.send(message, zmq::send_flags::none);
  }
  void Take() {
    zmq::message_t part;
    do {
      if (!router_.recv(part)) std::abort();
    } while (part.more());
  }

 private:
  // The first message tells the peer's name.
  void Take(std::nullptr_t) {
    peer_.send(zmq::str_buffer("hi"), zmq::send_flags::none);
    zmq::message_t id;
    if (!router_.recv(id)) std::abort();
    id_ = id.to_string();
    Take();
  }
  zmq::context_t context_;
  zmq::socket_t peer_;
  zmq::socket_t router_;
  std::string id_;
  std::thread echo_;
};

// ---- a coordinator's end of our own transport ----
class Server {
 public:
  explicit Server(const std::string& endpoint)
      : router_(wire::RouterSocket::Bind(context_, endpoint).value()) {
    poller_.Add(router_);
  }
  wire::Received Take() {
    while (true) {
      if (std::optional<wire::Received> received = router_.TryReceive()) {
        CAIRN_DEMAND(received->status.ok(), received->status.message());
        if (received->message.envelope.has_heartbeat()) continue;
        return std::move(*received);
      }
      poller_.Wait(std::chrono::seconds(10));
    }
  }
  void Send(const std::string& peer, const wire::Message& message) {
    Status sent = router_.Send(peer, message);
    for (; sent.code() == Code::kBusy; sent = router_.Send(peer, message))
      poller_.Wait(std::chrono::milliseconds(1));
    CAIRN_DEMAND(sent.ok(), sent.message());
  }

 private:
  wire::Context context_;
  wire::RouterSocket router_;
  wire::Poller poller_;
};

// Answers every message with itself, a blob with Missing (small), until Leave.
void ServeEcho(const std::string& endpoint) {
  const wire::Context context;
  wire::DealerSocket dealer = wire::DealerSocket::Connect(context, endpoint).value();
  wire::Poller poller;
  poller.Add(dealer);
  wire::Message hello;
  hello.envelope.mutable_hello();
  SendOver(dealer, poller, hello);
  while (true) {
    TakeEvents(dealer);
    while (std::optional<wire::Received> received = dealer.TryReceive()) {
      if (received->message.envelope.has_leave()) return;
      wire::Message answer = std::move(received->message);
      if (answer.envelope.has_blob()) {
        answer = {};
        answer.envelope.mutable_missing();
      }
      SendOver(dealer, poller, answer);
    }
    poller.Wait(std::chrono::seconds(10));
  }
}

class Trivial : public Pipeline {
 public:
  Step Start(const Inputs&) const override { return {}; }
  Blob Run(const Task& task, const Inputs&, Progress&) const override {
    Blob blob;
    blob.PutScalar<std::int64_t>("i", task.index());
    return blob;
  }
  Step Advance(const State&, Partials&, const Inputs&) const override { return {}; }
};

struct Figures {
  double round_trips = 0;  // a second
  double in_flight = 0;    // requests a second, kInFlight unanswered
  double bytes = 0;        // a second, in blobs of 16 MB
};

Figures MeasureBare(const std::string& endpoint) {
  Awaited answers("an answer of bare ZeroMQ's echo");
  BareEcho echo(endpoint);
  const auto small = [&] { echo.Ask(zmq::message_t(64)); };
  const auto large = [&, data = std::make_shared<std::string>(kBlobBytes, 'x')] {
    echo.Ask(zmq::message_t(data->data(), data->size(), [](void*, void*) {}));
  };
  const auto take = [&] { echo.Take(); };
  return {Rate(answers, kRoundTrips, 1, small, take), Rate(answers, kStreamed, kInFlight, small, take),
          Rate(answers, kBlobs, 4, large, take) * kBlobBytes};
}

Figures MeasureWire(const std::string& endpoint) {
  Awaited answers("an answer of the echo over schema/wire");
  Server server(endpoint);
  std::thread echo(ServeEcho, endpoint);
  const std::string peer = server.Take().peer;
  wire::Message small;
  small.envelope.mutable_cancel()->mutable_key()->set_job(std::string(48, 'x'));
  wire::Message large;
  large.envelope.mutable_blob();
  Blob blob;
  blob.PutVector("v", std::vector<double>(kBlobBytes / sizeof(double), 1.5));
  large.blobs = {wire::NameBlob(std::make_shared<const Blob>(std::move(blob)))};
  const auto take = [&] { server.Take(); };
  const Figures figures = {Rate(
                               answers, kRoundTrips, 1, [&] { server.Send(peer, small); }, take),
                           Rate(
                               answers, kStreamed, kInFlight, [&] { server.Send(peer, small); }, take),
                           Rate(answers, kBlobs, 4, [&] { server.Send(peer, large); }, take) * kBlobBytes};
  wire::Message leave;
  leave.envelope.mutable_leave();
  server.Send(peer, leave);
  echo.join();
  return figures;
}

Figures MeasureWorker(const std::string& endpoint) {
  Awaited answers("the worker's Hello or Done");
  Server server(endpoint);
  std::atomic<bool> stop{false};
  const std::unique_ptr<worker::ZmqTransport> transport = worker::ZmqTransport::Connect(endpoint).value();
  std::thread thread([&] {
    const auto factory = [](const proto::Stage&, std::uint64_t) { return std::make_unique<Trivial>(); };
    worker::WorkerOptions options;
    options.session.log = [](worker::Severity severity, const std::string& line) {
      if (severity != worker::Severity::kInfo) std::fprintf(stderr, "the worker: %s\n", line.c_str());
    };
    worker::RunWorker(*transport, factory, options, stop);
  });
  const std::string peer = server.Take().peer;
  wire::Message welcome;
  welcome.envelope.mutable_welcome()->set_heartbeat_s(1);
  server.Send(peer, welcome);
  wire::Message assign;
  assign.envelope.mutable_assign()->mutable_stage()->set_name("s");
  std::uint32_t next = 0;
  const auto ask = [&] {
    assign.envelope.mutable_assign()->mutable_task()->set_index(next);
    assign.envelope.mutable_assign()->mutable_key()->set_task(next++);
    server.Send(peer, assign);
  };
  const auto take = [&] { CAIRN_DEMAND(server.Take().message.envelope.has_done(), "a trivial task failed"); };
  const Figures figures = {Rate(answers, kRoundTrips, 1, ask, take),
                           Rate(answers, kStreamed, kInFlight, ask, take), 0};
  stop = true;
  transport->Wake();
  thread.join();
  return figures;
}

void Print(const char* what, const Figures& f, const Figures& bare) {
  std::printf("%-28s %9.0f /s (%4.2f) %11.0f /s (%4.2f)", what, f.round_trips,
              f.round_trips / bare.round_trips, f.in_flight, f.in_flight / bare.in_flight);
  if (f.bytes > 0) std::printf(" %8.2f GB/s (%4.2f)", f.bytes / 1e9, f.bytes / bare.bytes);
  std::printf("\n");
}

void KeepBest(Figures& best, const Figures& f) {
  best.round_trips = std::max(best.round_trips, f.round_trips);
  best.in_flight = std::max(best.in_flight, f.in_flight);
  best.bytes = std::max(best.bytes, f.bytes);
}

// The best of three, taken in turns: other work on the machine only ever slows things down.
void Main() {
  const wire::PrivateFolder folder;
  Figures bare, ours, worker;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    KeepBest(bare, MeasureBare(folder.Ipc("bare" + n)));
    KeepBest(ours, MeasureWire(folder.Ipc("wire" + n)));
    KeepBest(worker, MeasureWorker(folder.Ipc("worker" + n)));
  }
  std::printf("over ipc; in brackets: ratio to bare ZeroMQ in this run\n%-28s %19s %21s %20s\n", "",
              "one at a time", "64 in flight", "blobs of 16 MB");
  Print("bare ZeroMQ, 64 bytes", bare, bare);
  Print("schema/wire, an Envelope", ours, bare);
  Print("worker, a trivial task", worker, bare);
  std::fflush(stdout);
}

}  // namespace
}  // namespace cairn::bench

int main() {
  cairn::bench::Main();
  cairn::bench::PrintBlobRates();
}
