#include "schema/wire/context.h"

#include "schema/wire/internal.h"

namespace cairn::wire {

Context::Context() : impl_(std::make_shared<Impl>()) {}
Context::~Context() = default;

}  // namespace cairn::wire
