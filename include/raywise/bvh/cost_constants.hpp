// What the steps of a traversal cost, in box tests.
#pragma once

namespace raywise {

/// Cost constants of every builder and report. An inner node that is hit costs two box tests (its
/// children's), a leaf that is hit one triangle test per primitive; the root's own test is free.
/// [Falcone24]
struct CostConstants {
    double node = 1.0; ///< one box test; > 0
    double prim = 1.2; ///< one triangle test; > 0
};

} // namespace raywise
