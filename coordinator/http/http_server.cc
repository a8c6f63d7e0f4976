#include "coordinator/http/http_server.h"

#include <fcntl.h>
#include <microhttpd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>

#include "coordinator/http/listen.h"
#include "schema/wire/system_calls.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kStreamBlock = 32'768;

int SocketOf(MHD_Connection* connection) {
  return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

const std::string& Found(const std::map<std::string, std::string>& values, const std::string& name) {
  static const std::string kNone;
  const auto found = values.find(name);
  return found == values.end() ? kNone : found->second;
}

MHD_Result AddValue(void* into, MHD_ValueKind kind, const char* name, const char* value) {
  std::string key = name == nullptr ? "" : name;
  if (kind == MHD_HEADER_KIND)
    for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::string& kept = (*static_cast<std::map<std::string, std::string>*>(into))[key];
  const bool again = kind == MHD_HEADER_KIND && key == "content-length" && !kept.empty();
  kept = (again ? kept + ", " : "") + (value == nullptr ? "" : value);
  return MHD_YES;
}

HttpRequest HeadOf(MHD_Connection* connection, const char* path, const char* method) {
  HttpRequest request{.method = method, .path = path};
  MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, AddValue, &request.query);
  MHD_get_connection_values(connection, MHD_HEADER_KIND, AddValue, &request.headers);
  return request;
}

MHD_Result TakePart(void* upload, MHD_ValueKind, const char* field, const char* file, const char*,
                    const char*, const char* data, std::uint64_t at, std::size_t size) {
  try {
    static_cast<HttpUpload*>(upload)->Take(field == nullptr ? "" : field, file == nullptr ? "" : file, at,
                                           {data, size});
    return MHD_YES;
  } catch (...) {  // out of memory; the connection goes
    return MHD_NO;
  }
}

// The library takes 64 bytes for each argument, of the memory in which the head lies. Where that is short it
// (0.9.75) makes an answer that never goes out, and the connection stands until it is too silent.
bool TakesTooMuch(std::string_view uri, std::size_t head_bytes) {
  constexpr std::size_t kBytesPerArgument = 64, kShare = 4;
  if (uri.find('?') == std::string_view::npos) return false;
  const auto arguments = 1 + static_cast<std::size_t>(std::ranges::count(uri, '&'));
  return uri.size() + kBytesPerArgument * arguments > head_bytes / kShare;
}

// In place of an Exchange: of a request that has its answer, and of which nothing more comes to pass.
char refused = 0;

MHD_Response* ResponseOfFile(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  struct stat facts{};
  if (file >= 0 && ::fstat(file, &facts) == 0 && S_ISREG(facts.st_mode))
    return MHD_create_response_from_fd64(static_cast<std::uint64_t>(facts.st_size), file);
  if (file >= 0) ::close(file);
  return nullptr;
}

}  // namespace

std::string HttpRequest::Header(const std::string& name) const { return Found(headers, name); }
std::string HttpRequest::Query(const std::string& name) const { return Found(query, name); }

struct HttpServer::Impl : std::enable_shared_from_this<HttpServer::Impl> {
  struct Exchange;
  struct Streaming;

  HttpLimits limits;
  HttpHandler handler;
  HttpUploads uploads;
  std::string address;
  MHD_Daemon* daemon = nullptr;
  std::atomic<unsigned> streams = 0;

  std::deque<int> open;  // sockets of no streams, who asked last at the end; of the daemon's thread

  std::mutex mutex;  // of all below
  bool ending = false;
  std::uint64_t wakes = 0;
  std::set<MHD_Connection*> asleep;  // streams that wait for a Wake()
  std::set<Exchange*> awaiting;      // an answer

  // Of the daemon's thread.
  void Touch(MHD_Connection* connection) {
    const int socket = SocketOf(connection);
    std::erase(open, socket);
    open.push_back(socket);
  }
  MHD_Result Begin(MHD_Connection* connection, Exchange& exchange);
  MHD_Result Come(MHD_Connection* connection, Exchange& exchange, const char* data, std::size_t size);
  MHD_Result Go(MHD_Connection* connection, Exchange& exchange);
  MHD_Result Queue(MHD_Connection* connection, const HttpAnswer& answer);
  MHD_Response* StreamTo(MHD_Connection* connection, std::shared_ptr<HttpStream> stream);
  void End();

  static void* OnUri(void* self, const char* uri, MHD_Connection* connection);
  static MHD_Result OnRequest(void* self, MHD_Connection* connection, const char* path, const char* method,
                              const char* version, const char* data, std::size_t* size, void** exchange);
  static void OnCompleted(void* self, MHD_Connection* connection, void** exchange,
                          MHD_RequestTerminationCode why);
  static void OnConnection(void* self, MHD_Connection* connection, void** of_socket,
                           MHD_ConnectionNotificationCode what);
};

// One request and where its answer goes. It lives until connection and answerer have both done with it.
struct HttpServer::Impl::Exchange : HttpReply {
  std::shared_ptr<Impl> server;
  MHD_Connection* connection;  // null once it is gone
  HttpRequest request = {};
  MHD_PostProcessor* parts = nullptr;  // of an upload
  std::uint64_t came = 0;              // bytes of the body
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  bool handled = false;
  std::optional<HttpAnswer> answer = {};

  Exchange(std::shared_ptr<Impl> of, MHD_Connection* on) : server(std::move(of)), connection(on) {}
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;
  ~Exchange() override { EndParts(); }
  // False: what came is no form, or was cut short.
  bool EndParts() {
    MHD_PostProcessor* ended = std::exchange(parts, nullptr);
    return ended == nullptr || MHD_destroy_post_processor(ended) == MHD_YES;
  }
  void Send(HttpAnswer told) override {
    const std::lock_guard lock(server->mutex);
    if (connection == nullptr || answer) return;
    answer = std::move(told);
    if (server->awaiting.erase(this) > 0) MHD_resume_connection(connection);
  }
};

// What a stream has said, while it goes out.
struct HttpServer::Impl::Streaming {
  std::shared_ptr<Impl> server;
  MHD_Connection* connection;
  std::shared_ptr<HttpStream> stream;
  std::string text = {};
  std::size_t at = 0;

  static ssize_t Read(void* self, std::uint64_t, char* into, std::size_t most) {
    try {
      return static_cast<Streaming*>(self)->Copy(into, most);
    } catch (...) {  // out of memory; the connection goes
      return MHD_CONTENT_READER_END_WITH_ERROR;
    }
  }
  static void Free(void* self) {
    const std::unique_ptr<Streaming> gone(static_cast<Streaming*>(self));
    --gone->server->streams;
  }

 private:
  ssize_t Copy(char* into, std::size_t most) {
    while (at == text.size()) {
      std::uint64_t wakes = 0;
      {
        const std::lock_guard lock(server->mutex);
        if (server->ending) return MHD_CONTENT_READER_END_OF_STREAM;
        wakes = server->wakes;
      }
      text = stream->Next();
      at = 0;
      if (!text.empty()) break;
      const std::lock_guard lock(server->mutex);
      if (server->ending || stream->is_over()) return MHD_CONTENT_READER_END_OF_STREAM;
      if (wakes != server->wakes) continue;  // meanwhile there may be something
      server->asleep.insert(connection);
      MHD_suspend_connection(connection);
      return 0;
    }
    const std::size_t count = text.copy(into, most, at);
    at += count;
    return static_cast<ssize_t>(count);
  }
};

MHD_Response* HttpServer::Impl::StreamTo(MHD_Connection* connection, std::shared_ptr<HttpStream> stream) {
  auto streaming = std::make_unique<Streaming>(
      Streaming{.server = shared_from_this(), .connection = connection, .stream = std::move(stream)});
  MHD_Response* response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kStreamBlock, &Streaming::Read,
                                                             streaming.get(), &Streaming::Free);
  if (response == nullptr) return nullptr;
  streaming.release();
  ++streams;
  std::erase(open, SocketOf(connection));
  return response;
}

MHD_Result HttpServer::Impl::Queue(MHD_Connection* connection, const HttpAnswer& answer) {
  if (answer.stream != nullptr && streams >= limits.streams)
    return Queue(connection, {.code = MHD_HTTP_SERVICE_UNAVAILABLE, .body = "too many look on already\n"});
  MHD_Response* response =
      answer.stream != nullptr ? StreamTo(connection, answer.stream)
      : !answer.file.empty()
          ? ResponseOfFile(answer.file)
          : MHD_create_response_from_buffer(answer.body.size(), const_cast<char*>(answer.body.data()),
                                            MHD_RESPMEM_MUST_COPY);
  if (response == nullptr) return MHD_NO;
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, answer.type.c_str());
  for (const auto& [name, value] : answer.headers)
    MHD_add_response_header(response, name.c_str(), value.c_str());
  const MHD_Result queued = MHD_queue_response(connection, answer.code, response);
  MHD_destroy_response(response);
  return queued;
}

// By its head alone.
MHD_Result HttpServer::Impl::Begin(MHD_Connection* connection, Exchange& exchange) {
  constexpr std::size_t kPartsBuffer = 4096;
  HttpRequest& request = exchange.request;
  std::uint64_t announced = 0;
  const std::string length = request.Header("content-length");
  std::from_chars(length.data(), length.data() + length.size(), announced);
  // Where a body ends must be sure, also to a proxy before this server (RFC 9112, 6.3).
  if (length.find_first_not_of("0123456789") != std::string::npos ||
      (!length.empty() && !request.Header("transfer-encoding").empty()))
    return Queue(connection, {.code = MHD_HTTP_BAD_REQUEST,
                              .body = "how long the body is was said twice\n",
                              .headers = {{"Connection", "close"}}});
  // Before the colon is no space, which proxies read in different ways (RFC 9112, 5.1).
  for (const auto& [name, value] : request.headers)
    if (name.find_first_of(" \t") != std::string::npos)
      return Queue(connection, {.code = MHD_HTTP_BAD_REQUEST,
                                .body = "there is a space in a header's name\n",
                                .headers = {{"Connection", "close"}}});
  const bool form = uploads && request.method == "POST" &&
                    request.Header("content-type").starts_with("multipart/form-data");
  if (announced > (form ? limits.upload_bytes : limits.body_bytes))
    return Queue(connection, {.code = MHD_HTTP_CONTENT_TOO_LARGE, .body = "that is too much\n"});
  if (!form) return MHD_YES;
  auto begun = uploads(request);
  if (auto* refusal = std::get_if<HttpAnswer>(&begun)) return Queue(connection, *refusal);
  request.upload = std::get<std::shared_ptr<HttpUpload>>(begun);
  exchange.parts = MHD_create_post_processor(connection, kPartsBuffer, &TakePart, request.upload.get());
  return exchange.parts == nullptr ? MHD_NO : MHD_YES;
}

// A piece of the body.
MHD_Result HttpServer::Impl::Come(MHD_Connection* connection, Exchange& exchange, const char* data,
                                  std::size_t size) {
  exchange.came += size;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - exchange.began;
  const auto too_slow = [&](unsigned patience_s, unsigned slowest) {
    return took.count() > patience_s && static_cast<double>(exchange.came) < took.count() * slowest;
  };
  if (too_slow(limits.silent_s, limits.slowest)) return MHD_NO;
  if (exchange.parts != nullptr && too_slow(limits.upload_patience_s, limits.upload_slowest)) return MHD_NO;
  if (exchange.came > (exchange.parts != nullptr ? limits.upload_bytes : limits.body_bytes)) return MHD_NO;
  Touch(connection);
  if (exchange.parts != nullptr) return MHD_post_process(exchange.parts, data, size);
  exchange.request.body.append(data, size);
  return MHD_YES;
}

// The answer, where there is one; else the connection sleeps until there is.
MHD_Result HttpServer::Impl::Go(MHD_Connection* connection, Exchange& exchange) {
  HttpAnswer answer;
  {
    const std::lock_guard lock(mutex);
    if (!exchange.answer) {
      if (ending) return MHD_NO;
      awaiting.insert(&exchange);
      MHD_suspend_connection(connection);
      return MHD_YES;
    }
    answer = *exchange.answer;
  }
  return Queue(connection, answer);
}

// Before the library has taken the arguments.
void* HttpServer::Impl::OnUri(void* self, const char* uri, MHD_Connection* connection) {
  if (!TakesTooMuch(uri, static_cast<Impl*>(self)->limits.head_bytes)) return nullptr;
  constexpr std::string_view kAnswer =
      "HTTP/1.1 414 URI Too Long\r\nConnection: close\r\nContent-Type: text/plain\r\n\r\n"
      "those are too many arguments\n";
  static_cast<void>(::send(SocketOf(connection), kAnswer.data(), kAnswer.size(), MSG_NOSIGNAL));
  ::shutdown(SocketOf(connection), SHUT_RDWR);
  return &refused;
}

MHD_Result HttpServer::Impl::OnRequest(void* self, MHD_Connection* connection, const char* path,
                                       const char* method, const char*, const char* data, std::size_t* size,
                                       void** exchange) {
  try {
    Impl& server = *static_cast<Impl*>(self);
    if (*exchange == &refused) return MHD_NO;
    if (*exchange == nullptr) {
      auto fresh = std::make_shared<Exchange>(server.shared_from_this(), connection);
      fresh->request = HeadOf(connection, path, method);
      *exchange = new std::shared_ptr<Exchange>(fresh);
      server.Touch(connection);
      return server.Begin(connection, *fresh);
    }
    Exchange& here = **static_cast<std::shared_ptr<Exchange>*>(*exchange);
    if (*size > 0) {
      const MHD_Result taken = server.Come(connection, here, data, *size);
      *size = 0;
      return taken;
    }
    if (!here.EndParts()) here.request.upload = nullptr;
    if (!std::exchange(here.handled, true))
      server.handler(here.request, *static_cast<std::shared_ptr<Exchange>*>(*exchange));
    return server.Go(connection, here);
  } catch (...) {  // out of memory; the connection goes
    return MHD_NO;
  }
}

void HttpServer::Impl::OnCompleted(void* self, MHD_Connection*, void** exchange, MHD_RequestTerminationCode) {
  if (*exchange == &refused) return;
  const std::unique_ptr<std::shared_ptr<Exchange>> owner(static_cast<std::shared_ptr<Exchange>*>(*exchange));
  *exchange = nullptr;
  if (!owner) return;
  (*owner)->EndParts();
  (*owner)->request.upload = nullptr;  // one that broke off goes now
  const std::lock_guard lock(static_cast<Impl*>(self)->mutex);
  (*owner)->connection = nullptr;
  static_cast<Impl*>(self)->awaiting.erase(owner->get());
}

// A request is answered soon, so the oldest connection is one that does not ask.
void HttpServer::Impl::OnConnection(void* self, MHD_Connection* connection, void**,
                                    MHD_ConnectionNotificationCode what) {
  Impl& server = *static_cast<Impl*>(self);
  if (what == MHD_CONNECTION_NOTIFY_CLOSED) {
    std::erase(server.open, SocketOf(connection));
    return;
  }
  server.Touch(connection);
  if (server.open.size() <= server.limits.connections) return;
  ::shutdown(server.open.front(), SHUT_RDWR);
  server.open.pop_front();
}

// Nothing may sleep when the daemon stops.
void HttpServer::Impl::End() {
  {
    const std::lock_guard lock(mutex);
    ending = true;
    for (Exchange* exchange : awaiting) {
      exchange->answer = HttpAnswer{.code = MHD_HTTP_SERVICE_UNAVAILABLE, .body = "this server ends\n"};
      MHD_resume_connection(exchange->connection);
    }
    for (MHD_Connection* connection : asleep) MHD_resume_connection(connection);
    awaiting.clear();
    asleep.clear();
  }
  MHD_stop_daemon(daemon);
  wire::LeaveAlone(-1);
}

Result<std::unique_ptr<HttpServer>> HttpServer::Listen(const std::string& address, const std::string& purpose,
                                                       const HttpLimits& limits, HttpHandler handler,
                                                       HttpUploads uploads) {
  const Result<int> socket = ListenAt(address, purpose);
  if (!socket.ok()) return socket.status();
  auto impl = std::make_shared<Impl>();
  impl->address = NameOfSocket(socket.value());
  impl->limits = limits;
  impl->handler = std::move(handler);
  impl->uploads = std::move(uploads);
  wire::LeaveAlone(socket.value());
  // Room for as many again that were told to go and have not yet.
  impl->daemon = MHD_start_daemon(
      MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &Impl::OnRequest,
      impl.get(), MHD_OPTION_LISTEN_SOCKET, socket.value(), MHD_OPTION_CONNECTION_LIMIT,
      2 * limits.connections + limits.streams, MHD_OPTION_CONNECTION_TIMEOUT, limits.silent_s,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, limits.head_bytes, MHD_OPTION_URI_LOG_CALLBACK, &Impl::OnUri,
      impl.get(), MHD_OPTION_NOTIFY_CONNECTION, &Impl::OnConnection, impl.get(), MHD_OPTION_NOTIFY_COMPLETED,
      &Impl::OnCompleted, impl.get(), MHD_OPTION_END);
  if (impl->daemon == nullptr) {
    ::close(socket.value());
    return Status(Code::kIo, "cannot begin to listen on " + address + " for " + purpose);
  }
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(impl)));
}

HttpServer::HttpServer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() { impl_->End(); }

const std::string& HttpServer::address() const { return impl_->address; }
unsigned HttpServer::streams() const { return impl_->streams; }

void HttpServer::Wake() {
  const std::lock_guard lock(impl_->mutex);
  ++impl_->wakes;
  for (MHD_Connection* connection : impl_->asleep) MHD_resume_connection(connection);
  impl_->asleep.clear();
}

}  // namespace cairn::coordinator
