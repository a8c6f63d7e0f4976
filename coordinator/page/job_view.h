// The page of one job, in parts.
#pragma once

#include <string>

#include "coordinator/page/facts.h"
#include "coordinator/page/views.h"

namespace cairn::page {

Parts JobParts(const std::string& id, const ViewContext& context);

// "1/2 landmarks"
std::string StageText(const wire::JobInfo& job);

// What workers did in the last two minutes, a line each; of `job` in one colour and all others in another.
// Empty where there is nothing to draw.
std::string TimesHtml(const FleetTimes& times, const std::string& job);

}  // namespace cairn::page
