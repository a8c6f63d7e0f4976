#include "schema/wire/context.h"

#include <array>
#include <set>
#include <string>

#include "schema/wire/internal.h"
#include "schema/wire/keys.h"

namespace cairn::wire {
namespace {

constexpr const char* kZapEndpoint = "inproc://zeromq.zap.01";  // fixed by ZAP, rfc.zeromq.org/spec/27

std::string Z85(const zmq::message_t& key) {
  std::array<char, 41> text{};
  if (key.size() != 32) return "";
  zmq_z85_encode(text.data(), key.data<std::uint8_t>(), key.size());
  return text.data();
}

bool Allowed(Context::Impl& impl, const std::string& key) {
  std::filesystem::path path;
  {
    const std::lock_guard lock(impl.mutex);
    path = impl.allow_list;
  }
  const Result<std::set<std::string>> keys = ReadAllowList(path);
  return keys.ok() && keys.value().contains(key);  // an unreadable list allows nobody
}

// A request is: version, request id, domain, address, routing id, mechanism, credentials (CURVE: the client's
// key).
void Answer(Context::Impl& impl, zmq::socket_t& socket, const std::vector<zmq::message_t>& request) {
  const std::string id = request.size() > 1 ? request[1].to_string() : "";
  const bool curve = request.size() == 7 && request[5].to_string_view() == "CURVE";
  const std::string key = curve ? Z85(request[6]) : "";
  const bool allowed = !key.empty() && Allowed(impl, key);
  const std::array<std::string, 6> reply = {
      "1.0", id, allowed ? "200" : "400", allowed ? "" : "key not allowed", allowed ? key : "", ""};
  for (std::size_t i = 0; i < reply.size(); ++i) {
    socket.send(zmq::buffer(reply[i]),
                i + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
}

void ServeZap(Context::Impl& impl, zmq::socket_t socket) {
  try {
    while (true) {
      std::vector<zmq::message_t> request;
      do {
        request.emplace_back();
        if (!socket.recv(request.back())) return;
      } while (request.back().more());
      Answer(impl, socket, request);
    }
  } catch (const zmq::error_t&) {
    // The context shuts down.
  }
}

}  // namespace

Context::Impl::~Impl() {
  if (authenticator.joinable()) {
    zmq.shutdown();
    authenticator.join();
  }
}

Context::Context() : impl_(std::make_shared<Impl>()) {}
Context::~Context() = default;

Status Context::AllowClients(const std::filesystem::path& allow_list) {
  const Result<std::set<std::string>> keys = ReadAllowList(allow_list);
  if (!keys.ok()) return keys.status();
  const std::lock_guard lock(impl_->mutex);
  impl_->allow_list = allow_list;
  if (impl_->authenticator.joinable()) return Status::Ok();
  try {
    zmq::socket_t socket(impl_->zmq, zmq::socket_type::rep);
    socket.set(zmq::sockopt::linger, 0);
    socket.bind(kZapEndpoint);
    impl_->authenticator = std::thread(ServeZap, std::ref(*impl_), std::move(socket));
  } catch (const zmq::error_t& error) {
    return ZmqStatus("authenticator", error);
  }
  return Status::Ok();
}

}  // namespace cairn::wire
