#include "coordinator/server/metrics_port.h"

#include <microhttpd.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <mutex>
#include <utility>

#include "schema/wire/system_calls.h"

namespace cairn::coordinator {
namespace {

constexpr double kStale_s = 10;                // a loop that has left nothing for so long stands still
constexpr std::size_t kRequestBytes = 16'384;  // of a request's head

using Clock = std::chrono::steady_clock;

// "HOST", "PORT" of what a user wrote.
std::pair<std::string, std::string> SplitAddress(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return {"127.0.0.1", address};
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

std::string NameOf(int socket) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  auto* address = reinterpret_cast<sockaddr*>(&bound);
  if (::getsockname(socket, address, &size) != 0 ||
      ::getnameinfo(address, size, host.data(), host.size(), port.data(), port.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return "?";
  const std::string name = host.data();
  return (name.find(':') == std::string::npos ? name : "[" + name + "]") + ":" + port.data();
}

Result<int> Bind(const std::string& address) {
  const auto [host, port] = SplitAddress(address);
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  std::uint16_t number = 0;  // getaddrinfo takes 99999 for another
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  const bool is_port = error == std::errc() && end == port.data() + port.size();
  if (host.empty() || !is_port || ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found) != 0)
    return Status(Code::kRefused, "'" + address +
                                      "' is no address to listen on: PORT (of this machine "
                                      "alone), ADDRESS:PORT, 0.0.0.0:PORT (for all)");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  const int socket = ::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  constexpr int kOn = 1;
  if (socket >= 0 && ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &kOn, sizeof kOn) == 0 &&
      ::bind(socket, found->ai_addr, found->ai_addrlen) == 0 && ::listen(socket, SOMAXCONN) == 0)
    return socket;
  const int failure = errno;
  if (socket >= 0) ::close(socket);
  return Status(failure == EADDRINUSE ? Code::kBusy : Code::kRefused,
                "cannot listen on " + address + " for metrics: " + std::strerror(failure));
}

}  // namespace

HttpAnswer AnswerTo(std::string_view path, const Metrics* latest, double age_s) {
  if (path != "/metrics" && path != "/healthz" && path != "/readyz")
    return {404, "/metrics, /healthz, /readyz\n"};
  if (latest == nullptr) return {503, "the store is being read\n"};
  if (path == "/metrics") return {200, MetricsText(*latest)};
  if (age_s > kStale_s) return {503, "the event loop stands still\n"};
  if (path == "/readyz" && !latest->store_writable) return {503, "the store cannot be written\n"};
  return {200, "ok\n"};
}

struct MetricsPort::Impl {
  std::string address;
  unsigned connections = 0;
  MHD_Daemon* daemon = nullptr;

  std::mutex mutex;  // held for no longer than a pointer takes to copy
  std::shared_ptr<const Metrics> latest;
  Clock::time_point published;

  std::deque<int> open;  // sockets, the oldest first; of the daemon's thread

  HttpAnswer Answer(const char* method, const char* path) {
    if (std::strcmp(method, MHD_HTTP_METHOD_GET) != 0) return {MHD_HTTP_METHOD_NOT_ALLOWED, "GET alone\n"};
    std::shared_ptr<const Metrics> metrics;
    double age_s = 0;
    {
      const std::lock_guard lock(mutex);
      metrics = latest;
      age_s = std::chrono::duration<double>(Clock::now() - published).count();
    }
    return AnswerTo(path, metrics.get(), age_s);
  }

  static MHD_Result OnRequest(void* self, MHD_Connection* connection, const char* path, const char* method,
                              const char*, const char*, std::size_t*, void**) {
    try {
      const HttpAnswer answer = static_cast<Impl*>(self)->Answer(method, path);
      MHD_Response* response = MHD_create_response_from_buffer(
          answer.body.size(), const_cast<char*>(answer.body.data()), MHD_RESPMEM_MUST_COPY);
      MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE,
                              "text/plain; version=0.0.4; charset=utf-8");
      MHD_add_response_header(response, MHD_HTTP_HEADER_CONNECTION, "close");
      if (answer.code == MHD_HTTP_METHOD_NOT_ALLOWED)
        MHD_add_response_header(response, MHD_HTTP_HEADER_ALLOW, MHD_HTTP_METHOD_GET);
      const MHD_Result queued = MHD_queue_response(connection, answer.code, response);
      MHD_destroy_response(response);
      return queued;
    } catch (...) {  // out of memory; the connection goes
      return MHD_NO;
    }
  }

  // A request is answered as soon as it is there, so the oldest connection is one that does not ask.
  static void OnConnection(void* self, MHD_Connection* connection, void**,
                           MHD_ConnectionNotificationCode what) {
    std::deque<int>& open = static_cast<Impl*>(self)->open;
    const int socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) {
      std::erase(open, socket);
      return;
    }
    open.push_back(socket);
    if (open.size() <= static_cast<Impl*>(self)->connections) return;
    ::shutdown(open.front(), SHUT_RDWR);
    open.pop_front();
  }
};

Result<std::unique_ptr<MetricsPort>> MetricsPort::Listen(const std::string& address,
                                                         const MetricsPortLimits& limits) {
  const Result<int> socket = Bind(address);
  if (!socket.ok()) return socket.status();
  auto impl = std::make_unique<Impl>();
  impl->address = NameOf(socket.value());
  impl->connections = limits.connections;
  wire::LeaveAlone(socket.value());
  // Room for as many again that were told to go and have not yet.
  impl->daemon = MHD_start_daemon(
      MHD_USE_EPOLL_INTERNAL_THREAD, 0, nullptr, nullptr, &Impl::OnRequest, impl.get(),
      MHD_OPTION_LISTEN_SOCKET, socket.value(), MHD_OPTION_CONNECTION_LIMIT, 2 * limits.connections,
      MHD_OPTION_CONNECTION_TIMEOUT, limits.silent_s, MHD_OPTION_CONNECTION_MEMORY_LIMIT, kRequestBytes,
      MHD_OPTION_NOTIFY_CONNECTION, &Impl::OnConnection, impl.get(), MHD_OPTION_END);
  if (impl->daemon == nullptr) {
    ::close(socket.value());
    return Status(Code::kIo, "cannot begin to listen on " + address + " for metrics");
  }
  return std::unique_ptr<MetricsPort>(new MetricsPort(std::move(impl)));
}

MetricsPort::MetricsPort(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MetricsPort::~MetricsPort() {
  MHD_stop_daemon(impl_->daemon);
  wire::LeaveAlone(-1);
}

const std::string& MetricsPort::address() const { return impl_->address; }

void MetricsPort::Publish(const Metrics& metrics) {
  auto latest = std::make_shared<const Metrics>(metrics);
  const std::lock_guard lock(impl_->mutex);
  impl_->latest.swap(latest);
  impl_->published = Clock::now();
}

}  // namespace cairn::coordinator
