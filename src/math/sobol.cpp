#include "math/sobol.h"

#include "math/hash.h"
#include "math/joe_kuo.h"

namespace abbe {

namespace {

// Those of Joe and Kuo: the first four are hard to better, and 6 stands alone.
constexpr int kByJoeKuo[] = {0, 1, 2, 3, 6};

// Generator matrices of digital sequences in base 2. Two dimensions with the matrices M and P M, P being Pascal's
// triangle modulo 2 and M any upper triangular matrix with ones on its diagonal, are a (0, 2)-sequence as those with 1
// and P are, since M only takes the points of each aligned block in another order. So two dimensions that make a place
// or a direction are one, and their M are free for what pairs are worth together.
//
// The columns 1 … 11 of each M, row r as bit r, without the diagonal, were found by search, column by column: the
// fewest points too many in the elementary intervals of 2^m points, in the mean over all of them, of pairs of pairs and
// pairs with a single dimension that matter together (docs/decisions/010-sampler-dimensions.md). What they are worth
// together beyond 2^12 points is chance.
constexpr int kSearched = 12, kNone = -1;
struct Generator {
    int first, second; // dimensions: of M, and of P M
    std::uint32_t columns[kSearched - 1];
};
constexpr Generator kGenerators[] = {
    {4, 5, {0x0, 0x2, 0x5, 0x6, 0x18, 0x1, 0x44, 0x7a, 0x15b, 0x3fa, 0x615}},
    {7, 8, {0x0, 0x3, 0x7, 0x0, 0x6, 0x15, 0x2c, 0x13, 0x1c7, 0x33f, 0x75b}},
    {9, 10, {0x1, 0x3, 0x6, 0xc, 0x11, 0x2f, 0x13, 0x5a, 0x1b, 0x1b3, 0x3ad}},
    {11, 12, {0x0, 0x2, 0x2, 0xf, 0x1, 0x2e, 0x3d, 0xe4, 0x1e0, 0xa9, 0x6f}},
    {13, 14, {0x0, 0x2, 0x2, 0xf, 0x1, 0x32, 0x7f, 0x78, 0x19d, 0xa7, 0x3bc}},
    {16, 17, {0x1, 0x1, 0x5, 0xa, 0x1d, 0x8, 0x34, 0xbb, 0x22, 0x266, 0x7d7}},
    {18, 19, {0x1, 0x3, 0x6, 0xa, 0x2, 0x3f, 0x23, 0x51, 0x1c4, 0x15d, 0x412}},
    {20, 21, {0x0, 0x1, 0x4, 0x3, 0x1, 0x2d, 0x70, 0xfa, 0x1b1, 0x159, 0x7cb}},
    {22, 23, {0x1, 0x0, 0x5, 0x3, 0xc, 0x33, 0x2a, 0xcc, 0xa4, 0x205, 0x21b}},
    {15, kNone, {0x1, 0x2, 0x3, 0xc, 0x8, 0x12, 0x70, 0xdf, 0x101, 0x15, 0x17a}},
};

// Column by the number of its row's bit; those that were not searched at random.
constexpr std::uint32_t columnOf(const Generator& g, int column) {
    const std::uint32_t diagonal = 1u << column;
    if (column == 0) return diagonal;
    const std::uint32_t above =
        column < kSearched ? g.columns[column - 1] : mix32(static_cast<std::uint32_t>(32 * g.first + column));
    return diagonal | (above & (diagonal - 1));
}

// P times a column: row r is the sum of all rows whose number has the bits of r, as binomial coefficients are odd
// there.
constexpr std::uint32_t pascal(std::uint32_t column) {
    column ^= (column >> 1) & 0x55555555u;
    column ^= (column >> 2) & 0x33333333u;
    column ^= (column >> 4) & 0x0f0f0f0fu;
    column ^= (column >> 8) & 0x00ff00ffu;
    return column ^ ((column >> 16) & 0x0000ffffu);
}

constexpr std::uint32_t reversed(std::uint32_t x) {
    std::uint32_t r = 0;
    for (int b = 0; b < 32; ++b) r |= ((x >> b) & 1u) << (31 - b);
    return r;
}

constexpr void addColumn(SobolTable& table, int dimension, int column, std::uint32_t rows) {
    for (int value = 0; value < 16; ++value)
        if ((value >> (column % 4)) & 1) table.rows[column / 4][value][dimension] ^= rows;
}

constexpr SobolTable makeTable() {
    SobolTable table{};
    for (const int dimension : kByJoeKuo) {
        std::uint32_t v[32] = {};
        joeKuoDirections(dimension, v);
        for (int column = 0; column < 32; ++column) addColumn(table, dimension, column, reversed(v[column]));
    }
    for (const Generator& g : kGenerators)
        for (int column = 0; column < 32; ++column) {
            const std::uint32_t own = columnOf(g, column);
            addColumn(table, g.first, column, own);
            if (g.second != kNone) addColumn(table, g.second, column, pascal(own));
        }
    return table;
}

} // namespace

constexpr SobolTable kSobolTable = makeTable();

} // namespace abbe
