#include "coordinator/server/metrics_port.h"

#include <chrono>
#include <mutex>
#include <utility>

namespace cairn::coordinator {
namespace {

constexpr double kStale_s = 10;  // a loop that has left nothing for so long stands still

using Clock = std::chrono::steady_clock;

HttpAnswer TextAnswer(unsigned code, std::string body) {
  return {.code = code,
          .body = std::move(body),
          .type = "text/plain; version=0.0.4; charset=utf-8",
          .headers = {{"Connection", "close"}}};
}

}  // namespace

HttpAnswer AnswerTo(std::string_view path, const Metrics* latest, double age_s) {
  if (path != "/metrics" && path != "/healthz" && path != "/readyz")
    return TextAnswer(404, "/metrics, /healthz, /readyz\n");
  if (latest == nullptr) return TextAnswer(503, "the store is being read\n");
  if (path == "/metrics") return TextAnswer(200, MetricsText(*latest));
  if (age_s > kStale_s) return TextAnswer(503, "the event loop stands still\n");
  if (path == "/readyz" && !latest->store_writable) return TextAnswer(503, "the store cannot be written\n");
  return TextAnswer(200, "ok\n");
}

struct MetricsPort::Impl {
  std::mutex mutex;  // held for no longer than a pointer takes to copy
  std::shared_ptr<const Metrics> latest;
  Clock::time_point published;
  std::unique_ptr<HttpServer> server;  // the first to go

  HttpAnswer AnswerOf(const HttpRequest& request) {
    if (request.method != "GET") {
      HttpAnswer refusal = TextAnswer(405, "GET alone\n");
      refusal.headers.emplace_back("Allow", "GET");
      return refusal;
    }
    std::shared_ptr<const Metrics> metrics;
    double age_s = 0;
    {
      const std::lock_guard lock(mutex);
      metrics = latest;
      age_s = std::chrono::duration<double>(Clock::now() - published).count();
    }
    return AnswerTo(request.path, metrics.get(), age_s);
  }
};

Result<std::unique_ptr<MetricsPort>> MetricsPort::Listen(const std::string& address,
                                                         const HttpLimits& limits) {
  auto impl = std::make_unique<Impl>();
  Result<std::unique_ptr<HttpServer>> server = HttpServer::Listen(
      address, "metrics", limits,
      [&of = *impl](const HttpRequest& request, const auto& reply) { reply->Send(of.AnswerOf(request)); });
  if (!server.ok()) return server.status();
  impl->server = std::move(server).value();
  return std::unique_ptr<MetricsPort>(new MetricsPort(std::move(impl)));
}

MetricsPort::MetricsPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MetricsPort::~MetricsPort() = default;

const std::string& MetricsPort::address() const { return impl_->server->address(); }

void MetricsPort::Publish(const Metrics& metrics) {
  auto latest = std::make_shared<const Metrics>(metrics);
  const std::lock_guard lock(impl_->mutex);
  impl_->latest.swap(latest);
  impl_->published = Clock::now();
}

}  // namespace cairn::coordinator
