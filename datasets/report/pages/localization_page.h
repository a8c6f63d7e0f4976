// The report's page about localised robots.
#pragma once

#include <string>

#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's parts between title and footer. `result`: of kind `localization`; `samples`: what it was made
// from, null where errors are not asked for.
// Throws InputError: other samples, arrays that do not fit.
std::string LocalizationHtml(const Blob& result, const Blob* samples);

// Error by distance travelled, and how sure the robots are, as the bytes of a PNG.
// Throws as above.
std::string LocalizationPng(const Blob& result, const Blob* samples);

}  // namespace cairn::datasets::report
