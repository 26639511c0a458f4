// Which raywise this is.
#pragma once

#include <string>

namespace raywise::app {

/// "0.1.0 (4032bf5a1c2e)": the version and, if built from a repository, the commit.
[[nodiscard]] std::string version();

} // namespace raywise::app
