#include "schema/wire/socket.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>
#include <zmq.hpp>

#include "schema/wire/poller.h"
#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {
namespace {

constexpr std::chrono::seconds kPatience{300};  // far more than anything here takes

SocketOptions Quick() {
  SocketOptions options;
  options.reconnect_ms = 1;
  options.reconnect_max_ms = 10;
  options.linger_ms = 100;
  return options;
}

// Waits until `take` gives something.
template <class Socket, class Take>
auto Await(Socket& socket, const Take& take) -> decltype(take()) {
  Poller poller;
  poller.Add(socket);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    if (auto got = take()) return got;
    poller.Wait(std::chrono::milliseconds(50));
  }
  return {};
}

std::optional<Received> AwaitMessage(RouterSocket& s) {
  return Await(s, [&] { return s.TryReceive(); });
}
std::optional<Received> AwaitMessage(DealerSocket& s) {
  return Await(s, [&] { return s.TryReceive(); });
}
std::optional<LinkEvent> AwaitEvent(DealerSocket& s) {
  return Await(s, [&] { return s.TryEvent(); });
}

Message HelloMessage(const std::string& host) {
  Message message;
  message.envelope.mutable_hello()->set_protocol(kProtocol);
  message.envelope.mutable_hello()->set_host(host);
  return message;
}

Message BlobMessage(std::size_t doubles) {
  Blob blob;
  blob.PutVector<double>("values", std::vector<double>(doubles, 0.5));
  Message message;
  message.envelope.mutable_blob();
  message.blobs = {NameBlob(std::make_shared<const Blob>(std::move(blob)))};
  return message;
}

struct Link {
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
};

// A peer that speaks ZeroMQ but not Cairn.
void SendRaw(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    socket.send(zmq::buffer(frames[i]),
                i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

TEST(Socket, MessagesAndBlobsGoBothWays) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  for (const std::size_t doubles :
       {std::size_t{1}, std::size_t{1} << 20}) {  // copied, and sent without a copy
    ASSERT_TRUE(link.dealer.Send(BlobMessage(doubles)).ok());
    const std::optional<Received> up = AwaitMessage(link.router);
    ASSERT_TRUE(up && up->status.ok());
    EXPECT_EQ(up->message.blobs[0].hash, BlobMessage(doubles).blobs[0].hash);
    ASSERT_TRUE(link.router.Send(up->peer, up->message).ok());
    const std::optional<Received> down = AwaitMessage(link.dealer);
    ASSERT_TRUE(down && down->status.ok());
    EXPECT_EQ(down->message.blobs[0].blob->fields(), BlobMessage(doubles).blobs[0].blob->fields());
  }
}

// What a peer does not read is counted, and no more is kept for it than one message or the limit.
TEST(Socket, WhatAPeerDoesNotReadHasABound) {
  SocketOptions options = Quick();
  options.connections.unsent_bytes = 64 << 20;
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, options).value();
  zmq::context_t peers;
  zmq::socket_t peer(peers, zmq::socket_type::dealer);
  peer.set(zmq::sockopt::rcvhwm, 1);
  peer.connect(folder.Ipc("s"));
  SendRaw(peer, {Encode(HelloMessage("here")).envelope});
  const std::optional<Received> hello = AwaitMessage(router);
  ASSERT_TRUE(hello);
  EXPECT_EQ(router.Unsent(hello->peer), 0U);
  constexpr std::size_t kDoubles = 1 << 20;  // 8 MB
  const Message message = BlobMessage(kDoubles);
  std::size_t sent = 0;
  while (sent < 100 && router.Send(hello->peer, message).ok()) ++sent;
  EXPECT_GE(sent, 7U);
  EXPECT_LT(sent, 20U);
  EXPECT_EQ(router.Send(hello->peer, message).code(), Code::kBusy);
  EXPECT_GT(router.Unsent(hello->peer), 0U);
  zmq::message_t frame;
  for (std::size_t i = 0; i < sent;)
    if (peer.recv(frame)) i += frame.more() ? 0 : 1;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (router.Unsent(hello->peer) > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(router.Unsent(hello->peer), 0U);
  EXPECT_TRUE(router.Send(hello->peer, message).ok());
  peer.set(zmq::sockopt::linger, 0);
}

// Between a dealer and a router's socket file: what it reads it passes on, or, stalled, throws away. Both
// connections stand.
class Relay {
 public:
  Relay(const std::string& listens, const std::string& goes_to) : to_(goes_to), listener_(Unix()) {
    const sockaddr_un name = NameOf(listens);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    thread_ = std::thread([this] { Run(); });
  }
  ~Relay() {
    ended = true;
    thread_.join();
    for (const pollfd& end : ends_) ::close(end.fd);
    ::close(listener_);
  }
  std::atomic<bool> stalled = false, ended = false;

 private:
  static int Unix() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0); }
  static sockaddr_un NameOf(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.copy(name.sun_path, sizeof name.sun_path - 1);
    return name;
  }
  void Run() {
    while (!ended) {
      std::vector<pollfd> waits = ends_;
      waits.push_back({listener_, POLLIN, 0});
      ::poll(waits.data(), waits.size(), 5);
      if (waits.back().revents != 0) Accept();
      for (std::size_t i = 0; i + 1 < waits.size(); ++i)
        if (waits[i].revents != 0) Pass(i);
    }
  }
  void Accept() {
    const sockaddr_un name = NameOf(to_);
    ends_.push_back({::accept(listener_, nullptr, nullptr), POLLIN, 0});
    ends_.push_back({Unix(), POLLIN, 0});
    EXPECT_EQ(::connect(ends_.back().fd, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  }
  void Pass(std::size_t from) {
    char bytes[4096];
    const ssize_t count = ::read(ends_[from].fd, bytes, sizeof bytes);
    if (count <= 0) {
      ends_[from].events = 0;  // closed: the other end is left as it is
    } else if (!stalled) {
      EXPECT_EQ(::send(ends_[from ^ 1].fd, bytes, static_cast<std::size_t>(count), MSG_NOSIGNAL), count);
    }
  }

  const std::string to_;
  const int listener_;
  std::vector<pollfd> ends_;  // of one connection at k and k + 1
  std::thread thread_;
};

TEST(Socket, ADealerLeavesAConnectionThroughWhichNothingComes) {
  SocketOptions options = Quick();
  options.keepalive_ms = 50;
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, options).value();
  Relay relay((folder.path() / "relay").string(), (folder.path() / "s").string());
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("relay"), {}, options).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("before")).ok());
  ASSERT_TRUE(AwaitMessage(router));
  relay.stalled = true;
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  relay.stalled = false;
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
}

TEST(Socket, SendingToAnUnknownPeerSaysSo) {
  Link link;
  EXPECT_EQ(link.router.Send("nobody", HelloMessage("x")).code(), Code::kNotFound);
}

TEST(Socket, AnUnconnectedDealerKeepsNothingForLater) {
  PrivateFolder folder;
  Context context;
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  EXPECT_EQ(dealer.Send(HelloMessage("too early")).code(), Code::kBusy);
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("now")).ok());
  const std::optional<Received> first = AwaitMessage(router);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.envelope.hello().host(), "now");
}

TEST(Socket, TheDealerComesBackToARestartedRouter) {
  PrivateFolder folder;
  Context context;
  std::optional<RouterSocket> router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  router.reset();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  static_cast<void>(dealer.Send(HelloMessage("lost")));  // refused or lost, but never kept for later
  Result<RouterSocket> again = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick());
  ASSERT_TRUE(again.ok()) << again.status().message();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("again")).ok());
  const std::optional<Received> first = AwaitMessage(again.value());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.envelope.hello().host(), "again");
}

TEST(Socket, AConnectionLostInItsHandshakeIsNoRefusedKeyWhereThereAreNone) {
  PrivateFolder folder;
  Context context;
  const std::string path = (folder.path() / "s").string();
  const int listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  path.copy(name.sun_path, sizeof name.sun_path - 1);
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ::close(::accept(listener, nullptr, nullptr));
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  ::close(listener);
  ASSERT_TRUE(std::filesystem::remove(path));
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  // Every further loss is one too, until it stands.
  std::optional<LinkEvent> event = AwaitEvent(dealer);
  while (event == LinkEvent::kDisconnected) event = AwaitEvent(dealer);
  EXPECT_EQ(event, LinkEvent::kConnected);
}

TEST(Socket, AMalformedMessageDropsItsSenderAndNobodyElse) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  zmq::context_t raw_context;
  zmq::socket_t raw(raw_context, zmq::socket_type::dealer);
  raw.set(zmq::sockopt::linger, 0);
  raw.set(zmq::sockopt::reconnect_ivl, -1);
  raw.connect(link.folder.Ipc("s"));
  SendRaw(raw, {"\xff garbage"});
  const std::optional<Received> bad = AwaitMessage(link.router);
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->status.code(), Code::kCorrupt);
  EXPECT_EQ(link.router.Send(bad->peer, HelloMessage("x")).code(), Code::kNotFound);

  ASSERT_TRUE(link.dealer.Send(HelloMessage("fine")).ok());
  const std::optional<Received> good = AwaitMessage(link.router);
  ASSERT_TRUE(good && good->status.ok());
  EXPECT_EQ(good->message.envelope.hello().host(), "fine");
}

TEST(Socket, ADroppedPeersConnectionIsClosed) {
  Link link;
  ASSERT_EQ(AwaitEvent(link.dealer), LinkEvent::kConnected);
  // A message that its sender's Encode lets through and the receiver's smaller limits do not.
  SocketOptions narrow = Quick();
  narrow.limits.message_bytes = 1000;
  RouterSocket strict = RouterSocket::Bind(link.context, link.folder.Ipc("strict"), {}, narrow).value();
  DealerSocket dealer = DealerSocket::Connect(link.context, link.folder.Ipc("strict"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  Message message = BlobMessage(100);  // below MAXMSGSIZE a frame, above it with the next
  message.blobs[0] = NameBlob(std::make_shared<const Blob>(Blob::Fields{
      {"a", Array::Vector(std::vector<double>(100, 1))}, {"b", Array::Vector(std::vector<double>(100, 2))}}));
  ASSERT_TRUE(dealer.Send(message).ok());
  const std::optional<Received> bad = AwaitMessage(strict);
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->status.code(), Code::kRefused);
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(HelloMessage("sorry")).ok());
  const std::optional<Received> good = AwaitMessage(strict);
  ASSERT_TRUE(good && good->status.ok());
}

// Its messages outlive it, and whoever connects next has the descriptor that it had.
TEST(Socket, DroppingAPeerThatIsGoneClosesNobodyElsesConnection) {
  PrivateFolder folder;
  Context context;
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, Quick()).value();
  std::string gone;
  {
    DealerSocket first = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
    ASSERT_EQ(AwaitEvent(first), LinkEvent::kConnected);
    ASSERT_TRUE(first.Send(HelloMessage("first")).ok());
    const std::optional<Received> hello = AwaitMessage(router);
    ASSERT_TRUE(hello);
    gone = hello->peer;
  }
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (router.connections() > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ASSERT_EQ(router.connections(), 0U);
  DealerSocket second = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(second), LinkEvent::kConnected);
  router.Drop(gone);
  ASSERT_TRUE(second.Send(HelloMessage("second")).ok());
  const std::optional<Received> hello = AwaitMessage(router);
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->message.envelope.hello().host(), "second");
  ASSERT_TRUE(router.Send(hello->peer, HelloMessage("back")).ok());
  ASSERT_TRUE(AwaitMessage(second));
  EXPECT_EQ(second.TryEvent(), std::nullopt);
}

TEST(Socket, AFrameOverTheLimitIsStoppedByTheTransport) {
  PrivateFolder folder;
  Context context;
  SocketOptions narrow = Quick();
  narrow.limits = {.envelope_bytes = 1000, .message_bytes = 1000};
  RouterSocket router = RouterSocket::Bind(context, folder.Ipc("s"), {}, narrow).value();
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  ASSERT_TRUE(dealer.Send(BlobMessage(1000)).ok());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kDisconnected);
  EXPECT_FALSE(router.TryReceive());
}

TEST(Socket, ADealerThatGetsGarbageConnectsAgain) {
  PrivateFolder folder;
  zmq::context_t raw_context;
  zmq::socket_t raw(raw_context, zmq::socket_type::dealer);
  raw.set(zmq::sockopt::linger, 0);
  raw.bind(folder.Ipc("s"));
  Context context;
  DealerSocket dealer = DealerSocket::Connect(context, folder.Ipc("s"), {}, Quick()).value();
  ASSERT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
  SendRaw(raw, {"\xff garbage", "more"});
  const std::optional<Received> bad = AwaitMessage(dealer);
  ASSERT_TRUE(bad);
  EXPECT_FALSE(bad->status.ok());
  EXPECT_EQ(AwaitEvent(dealer), LinkEvent::kConnected);
}

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
  explicit RudeListener(std::string answer)
      : answer_(std::move(answer)), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = RawTcp::Loopback(0);
    socklen_t size = sizeof address;
    const int on = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 8), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] {
      while (true) {
        const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
        if (fd < 0) return;
        [[maybe_unused]] const ssize_t sent = ::send(fd, answer_.data(), answer_.size(), MSG_NOSIGNAL);
        ::shutdown(fd, SHUT_WR);
        char buffer[4096];
        while (::recv(fd, buffer, sizeof buffer, 0) > 0) {
        }
        ::close(fd);
      }
    });
  }
  ~RudeListener() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  RudeListener(const RudeListener&) = delete;
  RudeListener& operator=(const RudeListener&) = delete;
  const std::string& endpoint() const { return endpoint_; }

 private:
  const std::string answer_;
  const int listener_;
  std::string endpoint_;
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

TEST(Poller, AWakeupFromAnotherThreadEndsTheWait) {
  Link link;
  const Wakeup wakeup;
  Poller poller;
  poller.Add(link.router);
  poller.Add(wakeup);
  std::thread other([&] { wakeup.Signal(); });
  EXPECT_TRUE(poller.Wait(kPatience));
  other.join();
  EXPECT_FALSE(poller.Wait(std::chrono::milliseconds(0)));
}

}  // namespace
}  // namespace cairn::wire
