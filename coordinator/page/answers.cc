#include "coordinator/page/answers.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "coordinator/page/html.h"
#include "coordinator/page/views.h"

namespace cairn::page {

using coordinator::HttpAnswer;

HttpAnswer WithHeaders(HttpAnswer answer, const char* policy) {
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, const char*>>{
           {"Content-Security-Policy", policy},
           {"X-Frame-Options", std::string_view(policy) == kFramedReportPolicy ? "SAMEORIGIN" : "DENY"},
           {"X-Content-Type-Options", "nosniff"},
           {"Referrer-Policy", "same-origin"},
           {"Cross-Origin-Opener-Policy", "same-origin"},
           {"Cross-Origin-Resource-Policy", "same-origin"},
           {"Cache-Control", "no-store"}})
    answer.headers.emplace_back(name, value);
  return answer;
}

HttpAnswer Sentence(unsigned code, const std::string& title, const std::string& html) {
  return WithHeaders({.code = code,
                      .body = Page(title, "<h1>" + Text(title) + "</h1>\n" + html, "", "", ""),
                      .type = kHtml});
}

HttpAnswer NotHere() {
  return Sentence(404, "Not here", "<p>There is no such page. <a href=\"/\">All jobs</a></p>");
}

HttpAnswer GoTo(const std::string& path) {
  HttpAnswer answer = Sentence(303, "Done", "<p><a href=\"" + Text(path) + "\">Go on</a></p>");
  answer.headers.emplace_back("Location", path);
  return answer;
}

HttpAnswer JsonAnswer(bool ok, const std::string& text) {
  const nlohmann::json said = {{"ok", ok}, {"text", text}};
  return WithHeaders({.body = said.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                      .type = "application/json"});
}

}  // namespace cairn::page
