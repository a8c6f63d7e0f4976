#include "coordinator/server/metrics_port.h"

#include <gtest/gtest.h>

#include <vector>

#include "coordinator/http/testing/http_client.h"

namespace cairn::coordinator {
namespace {

std::string Get(const MetricsPort& port, const std::string& path, const std::string& method = "GET") {
  const HttpClient client(port.address());
  EXPECT_TRUE(client.Say(method + " " + path + " HTTP/1.1\r\nHost: here\r\n" + "Accept: */*\r\n" +
                         "X-Long: " + std::string(5000, 'x') + "\r\n\r\n"));
  return client.HearAll();
}

// Who asks as one should is answered.
void ExpectServes(const MetricsPort& port) {
  const std::string answer = Get(port, "/metrics");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n")) << answer.substr(0, 100);
  EXPECT_NE(answer.find("\ncairn_store_writable 1\n"), std::string::npos);
}

// Silence ends no connection here, unless a test is about that.
std::unique_ptr<MetricsPort> Listening(unsigned silent_s = 3600) {
  std::unique_ptr<MetricsPort> port = MetricsPort::Listen("0", {.silent_s = silent_s}).value();
  port->Publish({});
  return port;
}

TEST(AnswerTo, ReadyIsWhereTheLoopTurnsAndTheStoreCanBeWritten) {
  Metrics metrics;
  EXPECT_EQ(AnswerTo("/readyz", &metrics, 1).code, 200u);
  EXPECT_EQ(AnswerTo("/readyz", nullptr, 1).code, 503u) << "the store is still being read";
  EXPECT_EQ(AnswerTo("/readyz", &metrics, 11).code, 503u);
  metrics.store_writable = false;
  EXPECT_EQ(AnswerTo("/readyz", &metrics, 1).code, 503u);
}

TEST(AnswerTo, HealthyIsWhereTheLoopTurns) {
  Metrics metrics;
  metrics.store_writable = false;
  EXPECT_EQ(AnswerTo("/healthz", &metrics, 1).code, 200u);
  EXPECT_EQ(AnswerTo("/healthz", &metrics, 11).code, 503u);
  EXPECT_EQ(AnswerTo("/healthz", nullptr, 0).code, 503u);
}

TEST(AnswerTo, MetricsAreThoseOfTheLastTurnHoweverOld) {
  const Metrics metrics;
  EXPECT_EQ(AnswerTo("/metrics", &metrics, 1000).body, MetricsText(metrics));
  EXPECT_EQ(AnswerTo("/metrics", nullptr, 0).code, 503u);
}

TEST(MetricsPort, ServesTheLatestAndClosesAndIsOnLoopbackWhereNobodySaysOtherwise) {
  const std::unique_ptr<MetricsPort> port = Listening();
  EXPECT_TRUE(port->address().starts_with("127.0.0.1:")) << port->address();
  ExpectServes(*port);
  EXPECT_NE(Get(*port, "/metrics").find("Content-Type: text/plain; version=0.0.4"), std::string::npos);
  Metrics metrics;
  metrics.store_blobs = 42;
  port->Publish(metrics);
  EXPECT_NE(Get(*port, "/metrics").find("\ncairn_store_blobs 42\n"), std::string::npos);
  EXPECT_TRUE(Get(*port, "/readyz?x=1").starts_with("HTTP/1.1 200 "));
}

TEST(MetricsPort, ListensWhereItIsTold) {
  const auto six = MetricsPort::Listen("[::1]:0");  // a machine may know no IPv6
  EXPECT_TRUE(!six.ok() || six.value()->address().starts_with("[::1]:"));
  EXPECT_TRUE(MetricsPort::Listen("0.0.0.0:0").value()->address().starts_with("0.0.0.0:"));
  const std::unique_ptr<MetricsPort> port = Listening();
  EXPECT_EQ(MetricsPort::Listen(port->address()).status().code(), Code::kBusy);
  for (const char* wrong : {"", "x", ":", ":9", "127.0.0.1:", "127.0.0.1:http", "127.0.0.1:99999",
                            "1.2.3.4.5:9", "[::1:9]", "203.0.113.1:0"})
    EXPECT_EQ(MetricsPort::Listen(wrong).status().code(), Code::kRefused) << wrong;
}

TEST(MetricsPort, AnythingButAGetOfWhatThereIsIsRefused) {
  const std::unique_ptr<MetricsPort> port = Listening();
  for (const char* method : {"POST", "PUT", "DELETE", "HEAD", "OPTIONS", "TRACE", "NONSENSE"})
    EXPECT_TRUE(Get(*port, "/metrics", method).starts_with("HTTP/1.1 405 ")) << method;
  for (const char* path : {"/", "/metrics/", "/metrics/../healthz", "//metrics", "/etc/passwd"})
    EXPECT_TRUE(Get(*port, path).starts_with("HTTP/1.1 404 ")) << path;
  ExpectServes(*port);
}

TEST(MetricsPort, WhatIsNoHttpIsNotAnswered) {
  const std::unique_ptr<MetricsPort> port = Listening();
  for (const char* bytes :
       {"GET\r\n\r\n", "GET /metrics\r\n\r\n", "GET /metrics HTTP/9.9\r\n\r\n",
        "GET /metrics HTTP/1.1\r\nno colon\r\n\r\n", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"}) {
    const HttpClient client(port->address());
    client.Say(bytes);
    EXPECT_EQ(client.HearAll().find("cairn_store"), std::string::npos) << bytes;
  }
  const HttpClient binary(port->address());  // it is waited for, and for no other's sake
  binary.Say(std::string("\0\1\2\3\r\n\r\n", 8));
  ExpectServes(*port);
}

TEST(MetricsPort, OfAHeadWithoutEndOnlyTheBeginningIsRead) {
  const std::unique_ptr<MetricsPort> port = Listening();
  for (const std::string& head : {std::string("GET /"), std::string("GET /metrics HTTP/1.1\r\nX: ")}) {
    const HttpClient client(port->address());
    client.Say(head);
    std::size_t taken = 0;
    const std::string more(1 << 20, 'x');
    while (client.Say(more) && taken < (1u << 30)) taken += more.size();
    EXPECT_LT(taken, 64u << 20) << "beyond what the system keeps of a connection nobody reads on";
    EXPECT_EQ(client.HearAll().find("cairn_store"), std::string::npos);
  }
  ExpectServes(*port);
}

// Slowloris: each says the beginning of a request, and never the end.
TEST(MetricsPort, ThousandThatNeverEndTheirRequestHoldUpNobodyAndTheOldestGo) {
  const std::unique_ptr<MetricsPort> port = Listening();
  std::vector<HttpClient> slow;
  for (int i = 0; i < 1000; ++i) {
    slow.emplace_back(port->address());
    slow.back().Say("GET /metrics HTTP/1.1\r\nX-Slow: ");
  }
  ExpectServes(*port);
  if (HasFailure()) return;
  for (int i = 0; i < 900; ++i) slow[static_cast<std::size_t>(i)].HearAll();  // it is over: this returns
  ExpectServes(*port);
  // One of the last goes on, and is answered: it was not taken for an attacker.
  slow.clear();
  const HttpClient patient(port->address());
  for (const char byte : std::string("GET /metrics HTTP/1.1\r\nHost: here\r\n\r\n"))
    ASSERT_TRUE(patient.Say(std::string(1, byte)));
  EXPECT_NE(patient.HearAll().find("\ncairn_store_writable 1\n"), std::string::npos);
}

TEST(MetricsPort, WhoSaysNothingIsNotWaitedForForEver) {
  const std::unique_ptr<MetricsPort> port = Listening(1);
  const HttpClient silent(port->address());
  EXPECT_EQ(silent.HearAll(), "");
}

TEST(MetricsPort, ThousandThatAskAndDoNotReadHoldUpNobody) {
  const std::unique_ptr<MetricsPort> port = Listening();
  std::vector<HttpClient> deaf;
  for (int i = 0; i < 1000; ++i) {
    deaf.emplace_back(port->address());
    deaf.back().Say("GET /metrics HTTP/1.1\r\nHost: here\r\n\r\n");
  }
  port->Publish({});
  ExpectServes(*port);
}

TEST(MetricsPort, EndsThoughConnectionsStand) {
  std::unique_ptr<MetricsPort> port = Listening();
  const HttpClient silent(port->address());
  ExpectServes(*port);
  port.reset();
  EXPECT_EQ(silent.HearAll(), "");
}

}  // namespace
}  // namespace cairn::coordinator
