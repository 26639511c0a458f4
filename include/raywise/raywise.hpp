// Everything public, in one include.
#pragma once

#include <raywise/core/error.hpp>
