// The port for who watches a service, over HTTP and by GET alone: /metrics for Prometheus, /healthz and
// /readyz for whoever restarts what hangs. It has a thread of its own, which sees nothing but the latest
// metrics that the event loop has left there: no client, however slow, makes that wait.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "coordinator/http/http_server.h"
#include "coordinator/server/metrics.h"
#include "schema/error.h"

namespace cairn::coordinator {

// `latest`: null where the event loop has not turned yet. `age_s`: for how long it is the latest.
HttpAnswer AnswerTo(std::string_view path, const Metrics* latest, double age_s);

class MetricsPort {
 public:
  // `address`: PORT on loopback, HOST:PORT or [ADDRESS]:PORT; port 0: any that is free. kRefused: there is no
  // such address. kBusy: it is in use.
  static Result<std::unique_ptr<MetricsPort>> Listen(const std::string& address,
                                                     const HttpLimits& limits = {});
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
