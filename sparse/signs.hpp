#pragma once

namespace supple {

/// The weights that a fit may take.
enum class Signs { NonNegative, Any };

}  // namespace supple
