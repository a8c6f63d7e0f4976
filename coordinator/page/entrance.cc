#include "coordinator/page/entrance.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "coordinator/http/listen.h"

namespace cairn::page {
namespace {

using coordinator::HttpRequest;

constexpr double kSession_s = 24 * 3600;  // without being used
constexpr std::size_t kMostSessions = 1000;
constexpr double kMostFailures = 10;
constexpr double kFailureFades_s = 6;  // one of them is forgiven

// Takes as long whatever differs.
bool IsSame(const std::string& a, const std::string& b) {
  unsigned char different = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    different |= static_cast<unsigned char>(a[i] ^ (b.empty() ? 0 : b[i % b.size()]));
  return different == 0;
}

// "https://maps.example.org" -> "maps.example.org"
std::string HostOf(const std::string& origin) {
  const std::size_t slashes = origin.find("://");
  return slashes == std::string::npos ? origin : origin.substr(slashes + 3);
}

std::string Small(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// An address as browsers say it: in small letters, without the scheme's own port.
std::string AsBrowsersSay(const std::string& origin) {
  const std::string small = Small(origin);
  const std::string port = small.starts_with("https://") ? ":443" : ":80";
  return small.ends_with(port) ? small.substr(0, small.size() - port.size()) : small;
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::string Decoded(const std::string& text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? HexDigit(text[i + 1]) : -1;
    const int low = high < 0 ? -1 : HexDigit(text[i + 2]);
    if (low >= 0) {
      plain += static_cast<char>(16 * high + low);
      i += 2;
    } else {
      plain += text[i] == '+' ? ' ' : text[i];
    }
  }
  return plain;
}

}  // namespace

std::string RandomText(std::size_t bytes) {
  std::string text;
  while (text.size() < 2 * bytes) {
    std::array<unsigned char, 32> some{};
    if (::getrandom(some.data(), some.size(), 0) != static_cast<ssize_t>(some.size())) {
      if (errno == EINTR) continue;
      throw std::runtime_error("the system has no random numbers");
    }
    for (const unsigned char byte : some) text += fmt::format("{:02x}", byte);
  }
  text.resize(2 * bytes);
  return text;
}

std::map<std::string, std::string> FormValues(const std::string& body) {
  std::map<std::string, std::string> values;
  for (std::size_t at = 0; at <= body.size();) {
    const std::size_t end = std::min(body.find('&', at), body.size());
    const std::string pair = body.substr(at, end - at);
    const std::size_t equals = std::min(pair.find('='), pair.size());
    if (!pair.empty())
      values[Decoded(pair.substr(0, equals))] = Decoded(pair.substr(std::min(equals + 1, pair.size())));
    at = end + 1;
  }
  return values;
}

// Cookies do not tell ports apart, so its name does.
Entrance::Entrance(EntranceOptions options, std::function<void(const std::string&)> new_link)
    : options_(std::move(options)), new_link_(std::move(new_link)) {
  options_.proxy = AsBrowsersSay(options_.proxy);
  const auto [host, port] = coordinator::SplitAddress(options_.address);
  const bool secure = options_.proxy.starts_with("https://");
  origin_ = options_.proxy.empty() ? "http://" + options_.address : options_.proxy;
  cookie_ = secure ? "__Host-cairn_page" : "cairn_page_" + port;
  MakeLink();
}

void Entrance::MakeLink() {
  token_ = RandomText(24);
  new_link_(origin_ + "/?token=" + token_);
}

std::string Entrance::WhatIsWrongWithHost(const HttpRequest& request) const {
  std::string host = Small(request.Header("host"));
  if (!options_.proxy.empty())
    return host == HostOf(options_.proxy)
               ? ""
               : "this is " + HostOf(options_.proxy) + ", and no other name's page";
  const auto [name, port] = coordinator::SplitAddress(options_.address);
  if (const std::size_t colon = host.rfind(':'); colon == std::string::npos || host.ends_with(']'))
    host += ":80";
  const auto [asked, asked_port] = coordinator::SplitAddress(host);
  const bool loopback = coordinator::IsLoopback(name);
  const bool known =
      host == options_.address ||
      (asked_port == port && (!loopback || asked == "localhost" || asked == "127.0.0.1" || asked == "::1"));
  return known ? "" : "this page has the address " + origin_ + ", and no other";
}

// It is looked up by what it is, which nobody can guess bit by bit over a network.
Entrance::Sessions::const_iterator Entrance::SessionOf(const HttpRequest& request) const {
  const std::string cookies = "; " + request.Header("cookie"), name = "; " + cookie_ + "=";
  for (std::size_t at = cookies.find(name); at != std::string::npos; at = cookies.find(name, at)) {
    at += name.size();
    const auto session =
        sessions_.find(cookies.substr(at, std::min(cookies.find(';', at), cookies.size()) - at));
    if (session != sessions_.end()) return session;
  }
  return sessions_.end();
}

bool Entrance::Knows(const HttpRequest& request, double now_s) {
  const auto session = SessionOf(request);
  if (session == sessions_.end()) return false;
  if (now_s - session->second.used_s > kSession_s) {
    sessions_.erase(session);
    return false;
  }
  sessions_[session->first].used_s = now_s;
  return true;
}

bool Entrance::IsFormToken(const HttpRequest& request, const std::string& token) const {
  const std::string ours = FormToken(request);
  return !ours.empty() && IsSame(token, ours);
}

std::string Entrance::FormToken(const HttpRequest& request) const {
  const auto session = SessionOf(request);
  return session == sessions_.end() ? "" : session->second.form_token;
}

// No form and no link of another site can send this header, nor can its script unless it is allowed to, which
// nothing here does.
bool Entrance::IsOurOwn(const HttpRequest& request) const {
  const std::string origin = request.Header("origin"), site = request.Header("sec-fetch-site");
  if (!site.empty() && site != "same-origin") return false;
  const std::string scheme = options_.proxy.starts_with("https://") ? "https://" : "http://";
  return origin.empty() || origin == scheme + request.Header("host");
}

std::string Entrance::Admit(double now_s) {
  if (sessions_.size() >= kMostSessions) {
    const auto oldest =
        std::ranges::min_element(sessions_, {}, [](const auto& session) { return session.second.used_s; });
    sessions_.erase(oldest);
  }
  const std::string session = RandomText(24);
  sessions_[session] = {now_s, RandomText(24)};
  const char* secure = cookie_.starts_with("__Host-") ? "; Secure" : "";
  return cookie_ + "=" + session + "; Path=/; HttpOnly; SameSite=Strict" + secure;
}

std::optional<std::string> Entrance::TakeToken(const std::string& token, double now_s) {
  if (!IsSame(token, token_)) return std::nullopt;
  MakeLink();
  return Admit(now_s);
}

Result<std::string> Entrance::TakePassword(const std::string& password, double now_s) {
  failures_ = std::max(0.0, failures_ - (now_s - failures_s_) / kFailureFades_s);
  failures_s_ = now_s;
  if (!has_password()) return Status(Code::kRefused, "there is no password");
  if (failures_ >= kMostFailures) return Status(Code::kBusy, "too many passwords were wrong: wait a minute");
  if (IsSame(password, options_.password)) return Admit(now_s);
  failures_ += 1;
  return Status(Code::kRefused, "that is not the password");
}

void Entrance::Forget(const HttpRequest& request) {
  if (const auto session = SessionOf(request); session != sessions_.end()) sessions_.erase(session);
}

}  // namespace cairn::page
