// A real coordinator on TCP, an honest worker and a job, and at the same time everybody else: strangers, a
// worker and a submitter gone bad. The job ends with the same bits, what was refused is counted, memory stays
// bounded.
#include <gtest/gtest.h>

#include <zmq.hpp>

#include "schema/build_info.h"
#include "schema/numerics.h"
#include "schema/wire/testing/raw_peer.h"
#include "tests/faults/service_fixture.h"

namespace cairn::faults {
namespace {

constexpr std::size_t kMostMemory_kb = 600'000;  // of the coordinator, at its highest

std::size_t HighestMemory_kb(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string word; status >> word;) {
    std::size_t kb = 0;
    if (word == "VmHWM:" && status >> kb) return kb;
  }
  ADD_FAILURE() << "the coordinator's memory cannot be read";
  return 0;
}

class Hostile : public FaultsOnTcp {
 protected:
  void SetUp() override {
    FixNumericsOfProcess();
    FixNumericsOfThread();
    roles_["wicked"] = "worker";
    coordinator_more_ = {"--max-message-mb", "4"};
    FaultsOnTcp::SetUp();
    ::setenv("CAIRN_TASK_MS", "120", 1);  // as long as the attacks take
  }

  // A peer with a key, or without, that keeps to no rules of ours.
  zmq::socket_t Peer(const wire::KeyPair* keys) {
    zmq::socket_t socket(raw_, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::linger, 200);
    socket.set(zmq::sockopt::sndtimeo, 5000);
    socket.set(zmq::sockopt::rcvtimeo, 2000);
    socket.set(zmq::sockopt::immediate, true);
    if (keys != nullptr) {
      socket.set(zmq::sockopt::curve_serverkey, server_.public_key);
      socket.set(zmq::sockopt::curve_publickey, keys->public_key);
      socket.set(zmq::sockopt::curve_secretkey, keys->secret_key);
    }
    socket.connect(endpoint_);
    return socket;
  }
  static void Say(zmq::socket_t& socket, const std::vector<std::string>& frames) {
    for (std::size_t i = 0; i < frames.size(); ++i)
      static_cast<void>(socket.send(
          zmq::buffer(frames[i]), i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none));
  }
  static void Say(zmq::socket_t& socket, const wire::Envelope& envelope) {
    Say(socket, {envelope.SerializeAsString()});
  }

  // ---- attacks ----
  void Strangers() {
    wire::RawTcp(port_).Send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
    wire::RawTcp(port_).Send(std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03", 11));  // half a greeting
    wire::RawTcp(port_).Send(std::string(100'000, '\xff'));
    const wire::KeyPair unknown = wire::GenerateKeyPair();
    zmq::socket_t stranger = Peer(&unknown), keyless = Peer(nullptr);
    stranger.set(zmq::sockopt::sndtimeo, 200);
    keyless.set(zmq::sockopt::sndtimeo, 200);
    Say(stranger, {"let me in"});
    Say(keyless, {"let me in"});
  }
  void Garbage() {
    for (const std::vector<std::string>& frames : {std::vector<std::string>{"\xff\xff garbage"},
                                                   {std::string(3'000'000, 'x'), std::string(3'000'000, 'x')},
                                                   std::vector<std::string>(3, std::string(2'000'000, 'x')),
                                                   {std::string(8'000'000, 'x')}}) {
      zmq::socket_t wicked = Peer(&keys_.at("wicked"));
      Say(wicked, frames);
    }
  }
  wire::Envelope Hello(const std::string& host, std::int64_t pid) const {
    wire::Envelope envelope;
    wire::Hello& hello = *envelope.mutable_hello();
    hello.set_protocol(wire::kProtocol);
    *hello.mutable_build() = ThisBuild();
    hello.set_host(host);
    hello.set_pid(pid);
    hello.set_slots(2);
    return envelope;
  }
  // With another key, the honest worker's host and process id, as in a container of the same name: it is
  // another worker, which takes tasks and goes.
  void Namesake() {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    zmq::socket_t wicked = Peer(&keys_.at("wicked"));
    Say(wicked, Hello(host.data(), workers_.front().pid()));
  }
  // Answers to tasks that were never its own, each of them five times; to its own, answers without their
  // blob.
  void FalseAnswers() {
    zmq::socket_t wicked = Peer(&keys_.at("wicked"));
    Say(wicked, Hello("wicked", 1));
    const wire::JobInfo info = client_->Info(job_).value();
    for (std::uint32_t task = 0; task < kSlices; ++task) {
      wire::Envelope done;
      wire::TaskKey& key = *done.mutable_done()->mutable_key();
      key.set_job(job_);
      key.set_round(info.round() + task % 3);
      key.set_task(task);
      key.set_attempt(1 + task % 2);
      done.mutable_done()->set_partial(std::string(16, 'x'));
      for (int i = 0; i < 5; ++i) Say(wicked, done);
    }
    zmq::message_t frame;
    for (int i = 0; i < 20 && wicked.recv(frame); ++i) {
      wire::Envelope told, answer;
      if (!told.ParseFromArray(frame.data(), static_cast<int>(frame.size())) || !told.has_assign()) continue;
      *answer.mutable_done()->mutable_key() = told.assign().key();
      answer.mutable_done()->set_partial(std::string(16, 'x'));
      Say(wicked, answer);
      ++malformed_answers_;
    }
    wire::Envelope leave;
    leave.mutable_leave();
    Say(wicked, leave);
  }
  void BadSubmissions() {
    auto as_worker = coordinator::Client::Connect(
        {.endpoint = endpoint_,
         .security = wire::ClientSecurity{keys_.at("wicked"), server_.public_key},
         .timeout_s = 30});
    EXPECT_FALSE(as_worker.value().Submit(ToyJob(), {{"log", log_}}).ok());
    EXPECT_FALSE(as_worker.value().Drain(0).ok());
    proto::Job escapes = ToyJob(), crowd = ToyJob(), urgent = ToyJob();
    escapes.mutable_stages(0)->set_name("../../up");
    for (int i = 0; i < 200; ++i)
      (*crowd.add_stages() = ToyJob().stages(0)).set_name("s" + std::to_string(i));
    urgent.set_priority(2'000'000'000);
    for (const proto::Job& job : {escapes, crowd, urgent})
      EXPECT_FALSE(client_->Submit(job, {{"log", log_}}).ok()) << job.ShortDebugString().substr(0, 200);
  }
  // Through the command line: the file is refused before the service hears of it.
  void HostileFiles() {
    const std::string keys = folder_.path().string();
    std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n";
    for (char c = 'b'; c <= 'n'; ++c) {
      bomb += std::string(1, c) + ": &" + c + " [";
      for (int i = 0; i < 9; ++i) bomb += std::string(i > 0 ? ", *" : "*") + static_cast<char>(c - 1);
      bomb += "]\n";
    }
    const std::string stage = "inputs: {log: log.h5}\nstages:\n  - {pipeline: landmark_map, log: log, ";
    for (const std::string& text :
         {bomb + "inputs: {log: *n}\nstages: *n\n",
          stage + "name: a, options: {cell_m: 9223372036854775808e300}}\n",
          stage + "name: a, options: {iterations: 9223372036854775808}}\n",
          stage + "name: a, options: {cell_m: -1}}\n", stage + "name: ../../up}\n"}) {
      std::ofstream(folder_.path() / "job.yaml") << text;
      Process submit({CAIRN_PROGRAM, "submit", keys + "/job.yaml", "--connect", endpoint_, "--key",
                      keys + "/client.key", "--server-key", keys + "/coordinator.pub"},
                     folder_.path() / "submit.log");
      EXPECT_EQ(submit.Wait(), 2) << text.substr(0, 200);
    }
  }

  zmq::context_t raw_;
  int malformed_answers_ = 0;
};

TEST_F(Hostile, AServiceUnderAttackEndsItsJobWithTheSameBitsAndCountsWhatItRefused) {
  AddWorker();
  Submit();
  AwaitRound(1);
  for (int i = 0; i < 3; ++i) {
    // What is false of a job that is over would be refused for that alone.
    ASSERT_EQ(client_->Info(job_).value().state(), "running") << "the attacks come too late";
    Strangers();
    Garbage();
    Namesake();
    FalseAnswers();
    BadSubmissions();
  }
  HostileFiles();
  ExpectTheSameBits();
  EXPECT_GT(malformed_answers_, 0) << "the wicked worker was never asked anything";
  const auto counts = client_->List().value().refused;
  for (const char* kind : {"handshake", "key", "malformed", "oversized", "task", "right", "job"})
    EXPECT_GE(counts.contains(kind) ? counts.at(kind) : 0, 3u) << kind;
  for (const auto& [kind, count] : counts) std::cout << "refused: " << kind << " " << count << "\n";
  std::cout << malformed_answers_ << " malformed answers, coordinator at most "
            << HighestMemory_kb(coordinator_->pid()) / 1024 << " MiB\n";
  EXPECT_LT(HighestMemory_kb(coordinator_->pid()), kMostMemory_kb);
  EXPECT_FALSE(fs::exists(folder_.path().parent_path() / "up"));
}

}  // namespace
}  // namespace cairn::faults
