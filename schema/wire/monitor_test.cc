#include "schema/wire/monitor.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <optional>

#include "schema/wire/testing/private_folder.h"

namespace cairn::wire {
namespace {

constexpr timeval kMonitorPatience{20, 0};  // far more than anything here takes

// Takes connections and breaks them off.
class RudePeer {
 public:
  explicit RudePeer(const std::string& path) : listener_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.copy(name.sun_path, sizeof name.sun_path - 1);
    EXPECT_EQ(::setsockopt(listener_, SOL_SOCKET, SO_RCVTIMEO, &kMonitorPatience, sizeof kMonitorPatience),
              0);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&name), sizeof name), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
  }
  ~RudePeer() { ::close(listener_); }
  RudePeer(const RudePeer&) = delete;
  RudePeer& operator=(const RudePeer&) = delete;
  // False: none comes.
  bool BreakTheNext() const { return ::close(::accept(listener_, nullptr, nullptr)) == 0; }

 private:
  const int listener_;
};

struct MonitoredLink {
  PrivateFolder folder;
  RudePeer peer{(folder.path() / "s").string()};
  zmq::context_t context;
  zmq::socket_t dealer{context, zmq::socket_type::dealer};
  std::optional<Monitor> monitor{std::in_place, context, dealer,
                                 ZMQ_EVENT_CONNECTED | ZMQ_EVENT_DISCONNECTED};

  MonitoredLink() {
    dealer.set(zmq::sockopt::linger, 0);
    dealer.set(zmq::sockopt::reconnect_ivl, 1);
    dealer.connect(folder.Ipc("s"));
  }
  Monitor::Event Await() {
    zmq::pollitem_t item{monitor->handle(), 0, ZMQ_POLLIN, 0};
    zmq_poll(&item, 1, kMonitorPatience.tv_sec * 1000);
    return monitor->Next().value_or(Monitor::Event{});
  }
};

TEST(Monitor, TellsInOrderWhatBecomesOfAConnection) {
  MonitoredLink link;
  for (int i = 0; i < 3; ++i) {
    const Monitor::Event connected = link.Await();
    EXPECT_EQ(connected.kind, ZMQ_EVENT_CONNECTED);
    EXPECT_EQ(connected.where, link.folder.Ipc("s"));
    ASSERT_TRUE(link.peer.BreakTheNext());
    EXPECT_EQ(link.Await().kind, ZMQ_EVENT_DISCONNECTED);
  }
}

// Events come where nobody listens any more; ZeroMQ's thread would wait until somebody does.
TEST(Monitor, ThatHasGoneDoesNotHoldUpItsSocket) {
  MonitoredLink link;
  ASSERT_TRUE(link.peer.BreakTheNext());
  link.monitor.reset();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(link.peer.BreakTheNext()) << i;
}

}  // namespace
}  // namespace cairn::wire
