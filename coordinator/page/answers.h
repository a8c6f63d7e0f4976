// What every answer of the pages has with it, so that no other site makes anything of it.
#pragma once

#include <string>

#include "coordinator/http/http_server.h"

namespace cairn::page {

inline constexpr const char* kHtml = "text/html; charset=utf-8";
inline constexpr const char* kPagePolicy =
    "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'; object-src 'none'";
// A report has its styles and its script within it. They run in an origin of their own, from which they reach
// nothing: no page of ours, no cookie, no network.
inline constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

// The same within a page of ours.
inline constexpr const char* kFramedReportPolicy =
    "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

coordinator::HttpAnswer WithHeaders(coordinator::HttpAnswer answer, const char* policy = kPagePolicy);

// A page that says one sentence, which is `html`.
coordinator::HttpAnswer Sentence(unsigned code, const std::string& title, const std::string& html);
coordinator::HttpAnswer NotHere();
// To another page of these, after a form was sent.
coordinator::HttpAnswer GoTo(const std::string& path);
coordinator::HttpAnswer JsonAnswer(bool ok, const std::string& text);

}  // namespace cairn::page
