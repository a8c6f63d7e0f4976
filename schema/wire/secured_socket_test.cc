// Sockets over TCP, whose peers show a key.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "schema/wire/keys.h"
#include "schema/wire/socket.h"
#include "schema/wire/testing/link.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {
namespace {

TEST(Socket, BindingTwiceIsBusyAndTcpWithoutKeysRefused) {
  Link link;
  EXPECT_EQ(RouterSocket::Bind(link.context, "tcp://127.0.0.1:*").status().code(), Code::kRefused);
  EXPECT_EQ(DealerSocket::Connect(link.context, "tcp://127.0.0.1:1").status().code(), Code::kRefused);
  const KeyPair keys = GenerateKeyPair();
  std::ofstream(link.folder.path() / "allowed") << keys.public_key << " worker\nend\n";
  const ServerSecurity security{keys, link.folder.path() / "allowed"};
  const Result<RouterSocket> first = RouterSocket::Bind(link.context, "tcp://127.0.0.1:*", security);
  ASSERT_TRUE(first.ok()) << first.status().message();
  EXPECT_EQ(RouterSocket::Bind(link.context, first.value().endpoint(), security).status().code(),
            Code::kBusy);
}

// Of twenty thousand connections, as many as a process may often open files, ten thousand workers have
// theirs.
TEST(Places, OfManyConnectionsTheMostAreWorkers) {
  const Places few(20), usual(4096), many(20'000);
  EXPECT_EQ(few.workers, 10u);
  EXPECT_EQ(usual.workers, 2048u);
  EXPECT_EQ(usual.workers + usual.submitters + usual.viewers + usual.newcomers, 4096u);
  EXPECT_GT(many.of_a_workers_key, 10'000u);
  EXPECT_EQ(many.workers + many.submitters + many.viewers + many.newcomers, 20'000u);
}

class SecuredSocket : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path() / "allowed") << known_.public_key << " worker desk\nend\n";
    Result<RouterSocket> bound = RouterSocket::Bind(
        context_, "tcp://127.0.0.1:*", ServerSecurity{server_, folder_.path() / "allowed"}, Quick());
    ASSERT_TRUE(bound.ok()) << bound.status().message();
    router_.emplace(std::move(bound).value());
  }
  DealerSocket Connect(const KeyPair& keys, const std::string& server_key) {
    return DealerSocket::Connect(context_, router_->endpoint(), ClientSecurity{keys, server_key}, Quick())
        .value();
  }

  PrivateFolder folder_;
  Context context_;
  const KeyPair server_ = GenerateKeyPair();
  const KeyPair known_ = GenerateKeyPair();
  std::optional<RouterSocket> router_;
};

TEST_F(SecuredSocket, AKnownKeyIsLetInAndNamed) {
  DealerSocket dealer = Connect(known_, server_.public_key);
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("desk")).ok());
  const std::optional<Received> hello = AwaitMessage(*router_);
  ASSERT_TRUE(hello && hello->status.ok());
  EXPECT_EQ(hello->user_id, known_.public_key);
}

TEST_F(SecuredSocket, AnUnknownKeyIsRefused) {
  DealerSocket stranger = Connect(GenerateKeyPair(), server_.public_key);
  EXPECT_EQ(AwaitEvent(stranger), LinkEvent::kKeyRefused);
  EXPECT_EQ(stranger.Send(HelloMessage("x")).code(), Code::kBusy);
}

TEST_F(SecuredSocket, AKeyAddedToTheListIsLetInWithoutARestart) {
  const KeyPair late = GenerateKeyPair();
  DealerSocket dealer = Connect(late, server_.public_key);
  for (int asked = 0; asked < 20; ++asked) {  // whoever asks again in vain must not harm himself
    ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kKeyRefused) << asked;
    ASSERT_TRUE(dealer.Reconnect().ok());
  }
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kKeyRefused);
  std::ofstream(folder_.path() / "allowed") << late.public_key << " viewer\nend\n";
  ASSERT_TRUE(dealer.Reconnect().ok());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
}

TEST_F(SecuredSocket, AnImpostorOfTheServerIsNotTalkedTo) {
  DealerSocket dealer = Connect(known_, GenerateKeyPair().public_key);
  const std::optional<LinkEvent> event = AwaitEvent(dealer);
  ASSERT_TRUE(event);
  EXPECT_NE(*event, LinkEvent::kConnected);
}

// Takes connections on a port of its own, says `answer` to each, and breaks it off.
class RudeListener {
 public:
  explicit RudeListener(std::string answer) : answer_(std::move(answer)), thread_([this] { Run(); }) {}
  ~RudeListener() {
    ::shutdown(listener_.fd(), SHUT_RDWR);
    thread_.join();
  }
  RudeListener(const RudeListener&) = delete;
  RudeListener& operator=(const RudeListener&) = delete;
  const std::string& endpoint() const { return listener_.endpoint(); }

 private:
  void Run() const {
    for (int fd = listener_.AcceptFd(); fd >= 0; fd = listener_.AcceptFd()) {
      [[maybe_unused]] const ssize_t sent = ::send(fd, answer_.data(), answer_.size(), MSG_NOSIGNAL);
      ::shutdown(fd, SHUT_WR);
      char buffer[4096];
      while (::recv(fd, buffer, sizeof buffer, 0) > 0) {
      }
      ::close(fd);
    }
  }

  const std::string answer_;
  const RawListener listener_;
  std::thread thread_;
};

// One that is lost, and something else that answers: neither is the service's word, and it may be there soon.
TEST_F(SecuredSocket, AHandshakeThatIsBrokenOffIsNoRefusalAndIsTriedAgain) {
  for (const std::string answer : {"", "HTTP/1.1 400 Bad Request\r\n\r\n"}) {
    std::optional<RudeListener> rude(std::in_place, answer);
    const std::string endpoint = rude->endpoint();
    DealerSocket dealer =
        DealerSocket::Connect(context_, endpoint, ClientSecurity{known_, server_.public_key}, Quick())
            .value();
    EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kHandshakeFailed) << answer;
    EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kHandshakeFailed) << answer;
    EXPECT_EQ(dealer.Send(HelloMessage("x")).code(), Code::kBusy);
    rude.reset();
    Context other;  // one holds at most one that has keys
    Result<RouterSocket> bound =
        RouterSocket::Bind(other, endpoint, ServerSecurity{server_, folder_.path() / "allowed"}, Quick());
    ASSERT_TRUE(bound.ok()) << bound.status().message();
    router_.emplace(std::move(bound).value());
    std::optional<LinkEvent> event = AwaitEvent(dealer);
    while (event == LinkEvent::kHandshakeFailed) event = AwaitEvent(dealer);
    EXPECT_EQ(event, LinkEvent::kConnected) << answer;
  }
}

}  // namespace
}  // namespace cairn::wire
