// A service as its clients see it, for tests of those.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "schema/wire/codec.h"
#include "schema/wire/poller.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

// A service whose answers the test gives.
class FakeService {
 public:
  using Answer = std::function<std::optional<wire::Message>(const wire::Message&)>;
  // A question whose answer this is costs its connection.
  static wire::Message Dropped() {
    wire::Message message;
    message.envelope.mutable_leave();
    return message;
  }
  FakeService(const std::string& endpoint, Answer answer)
      : socket_(wire::RouterSocket::Bind(context_, endpoint).value()),
        thread_([this, answer] { Serve(answer); }) {}
  ~FakeService() {
    stop_ = true;
    wakeup_.Signal();
    thread_.join();
  }

 private:
  void Serve(const Answer& answer) {
    wire::Poller poller;
    poller.Add(socket_);
    poller.Add(wakeup_);
    while (!stop_) {
      poller.Wait(std::chrono::seconds(10));
      while (const std::optional<wire::Received> received = socket_.TryReceive()) {
        if (const std::optional<wire::Message> reply = answer(received->message)) {
          if (reply->envelope.has_leave())
            socket_.Drop(received->peer);
          else
            EXPECT_TRUE(socket_.Send(received->peer, *reply).ok());
        }
      }
    }
  }
  wire::Context context_;
  wire::Wakeup wakeup_;
  wire::RouterSocket socket_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

inline wire::Message Ok() {
  wire::Message message;
  message.envelope.mutable_reply()->set_ok(true);
  return message;
}

}  // namespace cairn::coordinator
