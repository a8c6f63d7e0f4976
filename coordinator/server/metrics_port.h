// The port for who watches a service, over HTTP and by GET alone: /metrics for Prometheus, /healthz and
// /readyz for whoever restarts what hangs. It has a thread of its own, which sees nothing but the latest
// metrics that the event loop has left there: no client, however slow, makes that wait.
//
// The library is libmicrohttpd: one thread for all connections, so that those who say nothing hold up nobody.
// With Debian's cpp-httplib 0.11 sixteen such connections kept a request waiting for 19 s, with
// prometheus-cpp 1.0 (civetweb) four for more than 20 s: they have a thread for each connection that they
// serve, and few.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "coordinator/server/metrics.h"
#include "schema/error.h"

namespace cairn::coordinator {

struct HttpAnswer {
  unsigned code = 200;
  std::string body;
};

// `latest`: null where the event loop has not turned yet. `age_s`: for how long it is the latest.
HttpAnswer AnswerTo(std::string_view path, const Metrics* latest, double age_s);

struct MetricsPortLimits {
  unsigned connections = 16;  // of more at a time the oldest goes
  unsigned silent_s = 10;     // then a connection goes
};

class MetricsPort {
 public:
  // `address`: PORT on loopback, HOST:PORT or [ADDRESS]:PORT; port 0: any that is free. kRefused: there is no
  // such address. kBusy: it is in use.
  static Result<std::unique_ptr<MetricsPort>> Listen(const std::string& address,
                                                     const MetricsPortLimits& limits = {});
  ~MetricsPort();
  MetricsPort(const MetricsPort&) = delete;
  MetricsPort& operator=(const MetricsPort&) = delete;

  // Waits for nobody.
  void Publish(const Metrics& metrics);
  const std::string& address() const;  // with the port that was chosen

  struct Impl;

 private:
  explicit MetricsPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace cairn::coordinator
