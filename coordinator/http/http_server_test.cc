#include "coordinator/http/http_server.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <thread>

#include "coordinator/http/listen.h"
#include "coordinator/http/testing/http_client.h"

namespace cairn::coordinator {
namespace {

// Says what it is told to say, then nothing until it is woken.
class Told : public HttpStream {
 public:
  std::string Next() override {
    const std::lock_guard lock(mutex_);
    return std::exchange(text_, "");
  }
  bool is_over() const override { return over_; }
  void Say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    text_ += text;
  }
  void End() { over_ = true; }

 private:
  std::mutex mutex_;
  std::string text_;
  std::atomic<bool> over_ = false;
};

class HttpServerTest : public ::testing::Test {
 protected:
  void Listen(const HttpLimits& limits) {
    server_ =
        HttpServer::Listen("0", "a test", limits, [this](const HttpRequest& request, const auto& reply) {
          if (request.path == "/late") {
            const std::lock_guard lock(mutex_);
            late_.push_back(reply);
            return;
          }
          if (request.path == "/stream") return reply->Send({.stream = stream_});
          if (request.path == "/file") return reply->Send({.file = request.Query("name")});
          reply->Send({.body = request.method + " " + request.path + " " + request.Query("a") + " " +
                               request.Header("x-some") + " [" + request.body + "]"});
        }).value();
  }
  std::string Ask(const std::string& request) {
    const HttpClient client(server_->address());
    EXPECT_TRUE(client.Say(request));
    return client.HearAll();
  }
  std::string Get(const std::string& path) {
    return Ask("GET " + path + " HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  }
  // Returns once so many have asked for /late.
  void AwaitLate(std::size_t count) {
    for (;;) {
      {
        const std::lock_guard lock(mutex_);
        if (late_.size() >= count) return;
      }
      std::this_thread::yield();
    }
  }

  std::shared_ptr<Told> stream_ = std::make_shared<Told>();
  std::mutex mutex_;
  std::vector<std::shared_ptr<HttpReply>> late_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(HttpServerTest, ABodyOfTwoLengthsIsRefusedAndTheConnectionClosed) {
  Listen({.body_bytes = 100});
  const std::string post = "POST /x HTTP/1.1\r\nHost: here\r\nContent-Length: 3\r\n";
  const std::string chunks = "3\r\nabc\r\n0\r\n\r\n";
  for (const std::string& request :
       {post + "Content-Length: 5\r\n\r\nabcde", post + "Transfer-Encoding: chunked\r\n\r\n" + chunks}) {
    const std::string answer = Ask(request);  // heard to its end: no second request is read
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 400 ")) << answer;
    EXPECT_EQ(answer.find("[abc"), std::string::npos);
  }
  EXPECT_NE(Ask(post + "Connection: close\r\n\r\nabc").find("[abc]"), std::string::npos);
}

// Whoever reads it as no length takes the body for the next request.
TEST_F(HttpServerTest, ASpaceBeforeAColonIsRefusedAndTheConnectionClosed) {
  Listen({.body_bytes = 100});
  for (const char* space : {" ", "\t"}) {
    const std::string answer =
        Ask("POST /x HTTP/1.1\r\nHost: here\r\nContent-Length" + std::string(space) + ": 3\r\n\r\nabc");
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 400 ")) << answer;
    EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos) << answer;
  }
}

TEST_F(HttpServerTest, HandsOnPathQueryHeadersAndBody) {
  Listen({.body_bytes = 100});
  const std::string answer =
      Ask("POST /a%2Fb?a=1%262&b HTTP/1.1\r\nHost: here\r\nX-Some: thing\r\nContent-Length: 5\r\nConnection: "
          "close\r\n\r\nhello");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 ")) << answer;
  EXPECT_NE(answer.find("POST /a/b 1&2 thing [hello]"), std::string::npos) << answer;
}

TEST_F(HttpServerTest, ArgumentsThatTakeTooMuchMemoryAreRefusedAtOnce) {
  Listen({.silent_s = 3600});
  const auto refusal = [&](std::size_t count, std::size_t length) {
    std::string query = "a=" + std::string(length, '1');
    for (std::size_t i = 1; i < count; ++i) query += "&a=" + std::string(length, '1');
    const std::string answer = Get("/x?" + query);
    return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : "'" + answer + "'";
  };
  for (const std::size_t length : {0, 1, 10, 100, 1000, 3000}) {
    EXPECT_EQ(refusal(1, length), "200") << length;
    for (const std::size_t bytes : {8000, 12000, 14000, 15000, 16000, 20000, 100000})
      EXPECT_EQ(refusal(std::max<std::size_t>(1, bytes / (length + 3)), length), "414")
          << bytes << ", " << length;
  }
  EXPECT_EQ(refusal(50, 5), "200");
  EXPECT_EQ(Ask("GET /late?" + std::string(100, '&') + " HTTP/1.1\r\nHost: here\r\n\r\n").substr(9, 3),
            "414");
  EXPECT_TRUE(late_.empty()) << "nobody is asked";
}

TEST_F(HttpServerTest, ABodyThatIsTooLargeIsRefusedBeforeItComesOrBreaksOff) {
  Listen({.body_bytes = 100});
  EXPECT_TRUE(Ask("POST / HTTP/1.1\r\nHost: here\r\nContent-Length: 101\r\nConnection: close\r\n\r\n")
                  .starts_with("HTTP/1.1 413 "));
  // One that does not say how large it is.
  const std::string chunk = "40\r\n" + std::string(64, 'x') + "\r\n";
  EXPECT_EQ(Ask("POST / HTTP/1.1\r\nHost: here\r\nTransfer-Encoding: chunked\r\n\r\n" + chunk + chunk + chunk)
                .find("200"),
            std::string::npos);
  EXPECT_NE(Get("/still").find("GET /still"), std::string::npos);
}

TEST_F(HttpServerTest, AnAnswerMayComeLaterFromAnotherThreadAndHoldsUpNobody) {
  Listen({});
  const HttpClient waits(server_->address());
  waits.Say("GET /late HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  AwaitLate(1);
  EXPECT_NE(Get("/other").find("GET /other"), std::string::npos);
  std::thread([&] { late_[0]->Send({.body = "at last"}); }).join();
  EXPECT_NE(waits.HearAll().find("at last"), std::string::npos);
  late_[0]->Send({.body = "twice"});  // is for nobody
}

TEST_F(HttpServerTest, AnAnswerToWhoIsGoneIsForNobody) {
  Listen({});
  {
    const HttpClient gone(server_->address());
    gone.Say("GET /late HTTP/1.1\r\nHost: here\r\n\r\n");
    AwaitLate(1);
  }
  late_[0]->Send({.body = "too late"});
  server_.reset();
  late_[0]->Send({.body = "much too late"});
}

TEST_F(HttpServerTest, AStreamSaysMoreEachTimeThatItIsWokenUntilItIsOver) {
  Listen({.streams = 1});
  stream_->Say("one;");
  const HttpClient client(server_->address());
  client.Say("GET /stream HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n");
  client.HearUntil("one;");
  for (const char* word : {"two;", "three;"}) {
    stream_->Say(word);
    server_->Wake();
    client.HearUntil(word);
  }
  EXPECT_EQ(server_->streams(), 1u);
  EXPECT_TRUE(Get("/stream").starts_with("HTTP/1.1 503 ")) << "there is room for one";
  stream_->Say("end");
  stream_->End();
  server_->Wake();
  EXPECT_NE(client.HearAll().find("end"), std::string::npos);
}

// Of those that are not streams the oldest go.
TEST_F(HttpServerTest, MassesOfSilentConnectionsEndNoStream) {
  Listen({.connections = 8, .streams = 1, .silent_s = 3600});
  stream_->Say("begins;");
  const HttpClient client(server_->address());
  client.Say("GET /stream HTTP/1.1\r\nHost: here\r\n\r\n");
  client.HearUntil("begins;");
  std::vector<HttpClient> silent;
  for (int i = 0; i < 200; ++i) {
    silent.emplace_back(server_->address());
    silent.back().Say("GET /");
  }
  EXPECT_NE(Get("/x").find("GET /x"), std::string::npos);
  silent.front().HearAll();
  stream_->Say("goes on;");
  server_->Wake();
  client.HearUntil("goes on;");
}

// What nobody reads waits in its own connection.
TEST_F(HttpServerTest, WhoDoesNotReadItsStreamHoldsUpNobody) {
  Listen({.streams = 64});
  stream_->Say(std::string(16 << 20, 'x'));
  const HttpClient deaf(server_->address());
  deaf.Say("GET /stream HTTP/1.1\r\nHost: here\r\n\r\n");
  for (int i = 0; i < 20; ++i) {
    server_->Wake();
    EXPECT_NE(Get("/x").find("GET /x"), std::string::npos);
  }
}

TEST_F(HttpServerTest, SendsFilesAndNothingElse) {
  Listen({});
  const std::string name = ::testing::TempDir() + "cairn_http_" + std::to_string(::getpid());
  std::ofstream(name) << "what is in it";
  EXPECT_NE(Get("/file?name=" + name).find("what is in it"), std::string::npos);
  ::unlink(name.c_str());
  ASSERT_EQ(::symlink("/etc/hostname", name.c_str()), 0);
  for (const std::string& none : {name, std::string("/dev/zero"), std::string("/nowhere"), std::string("/")})
    EXPECT_EQ(Get("/file?name=" + none), "") << none;
  ::unlink(name.c_str());
}

TEST_F(HttpServerTest, EndsThoughAnswersAreAwaitedAndStreamsSleep) {
  Listen({.streams = 2});
  stream_->Say("begins;");
  const HttpClient waits(server_->address()), listens(server_->address());
  waits.Say("GET /late HTTP/1.1\r\nHost: here\r\n\r\n");
  listens.Say("GET /stream HTTP/1.1\r\nHost: here\r\n\r\n");
  listens.HearUntil("begins;");
  AwaitLate(1);
  server_.reset();
  waits.HearAll();
  listens.HearAll();
}

TEST(Listen, AStarIsNoAddress) {
  const auto listened = ListenAt("*:0", "a test");
  ASSERT_FALSE(listened.ok());
  EXPECT_NE(listened.status().message().find("0.0.0.0:PORT (for all)"), std::string::npos);
}

TEST(Listen, LoopbackIsWhatOnlyThisMachineReaches) {
  for (const char* host : {"127.0.0.1", "127.5.4.3", "::1", "localhost"})
    EXPECT_TRUE(IsLoopback(host)) << host;
  for (const char* host : {"0.0.0.0", "::", "10.0.0.5", "128.0.0.1", ""})
    EXPECT_FALSE(IsLoopback(host)) << host;
}

}  // namespace
}  // namespace cairn::coordinator
