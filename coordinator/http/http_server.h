// HTTP on a port, for whoever watches a service: metrics_port.h, and the pages of cairn-page.
//
// The library is libmicrohttpd: one thread for all connections, so that those who say nothing hold up nobody.
// With Debian's cpp-httplib 0.11 sixteen such connections kept a request waiting for 19 s, with
// prometheus-cpp 1.0 (civetweb) four for more than 20 s: they have a thread for each connection that they
// serve, and few.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "schema/error.h"

namespace cairn::coordinator {

// What a form brings that is no text to be kept in memory (multipart/form-data), as it comes. Called on the
// server's thread, which it may not hold up. Where it breaks off, it is let go of and nobody is asked.
class HttpUpload {
 public:
  virtual ~HttpUpload() = default;
  // A part of a field's value, which begins `at` bytes behind its begin; `file` is what the file of it was
  // called, by a stranger.
  virtual void Take(const std::string& field, const std::string& file, std::uint64_t at,
                    std::string_view bytes) = 0;
};

struct HttpRequest {
  std::string method, path;  // the path is decoded: %2F is a slash
  std::map<std::string, std::string> query = {};
  std::map<std::string, std::string> headers = {};  // by their names in small letters; of two the last
  std::string body = {};                            // empty where there is an upload
  std::shared_ptr<HttpUpload> upload = nullptr;     // null where what came was no whole form

  std::string Header(const std::string& name) const;  // empty where there is none
  std::string Query(const std::string& name) const;
};

// An answer that goes on. Called on the server's thread: it may not wait.
class HttpStream {
 public:
  virtual ~HttpStream() = default;
  virtual std::string Next() = 0;  // what there is to say; empty: nothing until the next Wake()
  virtual bool is_over() const { return false; }  // where Next() is empty: there will be nothing more
};

struct HttpAnswer {
  unsigned code = 200;
  std::string body = {};
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers = {};
  std::filesystem::path file = {};               // whose bytes are the body, where it is not empty
  std::shared_ptr<HttpStream> stream = nullptr;  // in place of a body
};

// Where the answer to one request goes.
class HttpReply {
 public:
  virtual ~HttpReply() = default;
  // Once, from any thread, also after the connection is gone.
  virtual void Send(HttpAnswer answer) = 0;
};
// Called on the server's thread: it may not wait, but may leave the answer to another thread. What it throws
// ends the connection.
using HttpHandler = std::function<void(const HttpRequest&, const std::shared_ptr<HttpReply>&)>;
// Of a POST of multipart/form-data, before anything of it has come: where it goes, or the answer that refuses
// it.
using HttpUploads = std::function<std::variant<std::shared_ptr<HttpUpload>, HttpAnswer>(const HttpRequest&)>;

struct HttpLimits {
  unsigned connections = 16;         // of more at a time the oldest goes that is no stream
  unsigned streams = 0;              // of more a request is answered with 503
  unsigned silent_s = 10;            // then a connection goes, unless an answer is awaited
  std::size_t head_bytes = 16'384;   // of a request
  std::size_t body_bytes = 0;        // of more a request is answered with 413
  std::uint64_t upload_bytes = 0;    // the same of an upload, before it comes; one that says less breaks off
  unsigned slowest = 1000;           // bytes a second, of a body that has been coming for `silent_s`
  unsigned upload_patience_s = 60;   // from then on, of an upload:
  unsigned upload_slowest = 64'000;  // bytes a second, on average since it began
};

class HttpServer {
 public:
  // `address`, `purpose`: listen.h.
  static Result<std::unique_ptr<HttpServer>> Listen(const std::string& address, const std::string& purpose,
                                                    const HttpLimits& limits, HttpHandler handler,
                                                    HttpUploads uploads = nullptr);
  // Ends all connections; the handler is not called any more.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  const std::string& address() const;  // with the port that was chosen
  void Wake();                         // streams may have more to say; from any thread
  unsigned streams() const;            // that are open

  struct Impl;

 private:
  explicit HttpServer(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace cairn::coordinator
