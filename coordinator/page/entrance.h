// Who is let in to the pages: who has a link that works once, or the password; from then on by a cookie. And
// which requests come from the pages themselves, and not from another site that the same browser shows.
//
// Not for several threads.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "coordinator/http/http_server.h"
#include "schema/error.h"

namespace cairn::page {

struct EntranceOptions {
  std::string address;   // HOST:PORT that is listened at
  std::string proxy;     // "https://maps.example.org": the address before it that people see; empty: none
  std::string password;  // empty: none
};

class Entrance {
 public:
  // `new_link`: called with each link that works once: the first now, another where one was used.
  Entrance(EntranceOptions options, std::function<void(const std::string&)> new_link);

  // Why nobody is served who calls this by another name (a page of another site whose name leads here);
  // empty: he is.
  std::string WhatIsWrongWithHost(const coordinator::HttpRequest& request) const;
  // Whether it has a cookie of somebody who was let in.
  bool Knows(const coordinator::HttpRequest& request, double now_s);
  // Whether one of these pages itself sends it, and no other that the browser shows.
  bool IsOurOwn(const coordinator::HttpRequest& request) const;
  // What a form of a page of his has with it, for what it sends can have no header; empty: he is not known.
  std::string FormToken(const coordinator::HttpRequest& request) const;
  bool IsFormToken(const coordinator::HttpRequest& request, const std::string& token) const;

  // What to set as a cookie; none where it is not right.
  std::optional<std::string> TakeToken(const std::string& token, double now_s);
  // kRefused: it is not right. kBusy: too many were not; later.
  Result<std::string> TakePassword(const std::string& password, double now_s);
  void Forget(const coordinator::HttpRequest& request);
  bool has_password() const { return !options_.password.empty(); }

 private:
  struct Session {
    double used_s = 0;  // last
    std::string form_token;
  };
  using Sessions = std::map<std::string, Session>;

  // Of a cookie of ours, which may stand behind others of its name: whoever serves another port of the same
  // host can set such.
  Sessions::const_iterator SessionOf(const coordinator::HttpRequest& request) const;
  std::string Admit(double now_s);
  void MakeLink();

  EntranceOptions options_;
  std::function<void(const std::string&)> new_link_;
  std::string origin_;  // "http://127.0.0.1:8080"
  std::string cookie_;  // its name
  std::string token_;
  Sessions sessions_;
  double failures_ = 0, failures_s_ = 0;  // passwords that were wrong, which are forgotten with time
};

// 0x00…: so many bytes of the system's randomness, as hexadecimal digits.
std::string RandomText(std::size_t bytes);

// "name=value&…" as forms send it.
std::map<std::string, std::string> FormValues(const std::string& body);

}  // namespace cairn::page
