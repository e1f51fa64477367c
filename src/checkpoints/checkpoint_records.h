// The records of a checkpoint as the bytes of its blocks: header and tiles. docs/checkpoints.md describes them.
#pragma once

#include "checkpoints/checkpoint_bytes.h"
#include "checkpoints/checkpoint_file.h"
#include "film/film_planes.h"

#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

inline constexpr char kCheckpointMagic[8] = {'A', 'B', 'B', 'E', 'C', 'K', 'P', 'T'};
inline constexpr std::uint32_t kCheckpointVersion = 8;

enum BlockKind : std::uint32_t {
    headerBlock = 1,
    tileBlock = 2,
    endBlock = 3,
    lightBlock = 4,
    splatBlock = 5,
    layerBlock = 6,      // of the tile before it
    layerSplatBlock = 7, // of the tile whose splats are before it
};
// In which of a tile's blocks a plane is.
BlockKind blockOf(const FilmPlane&);
bool hasPlanesIn(const FilmPlanes&, BlockKind);

// What comes before the bytes of a block; its hash comes after them.
struct BlockHead {
    std::uint32_t kind = 0, reserved = 0;
    std::uint64_t size = 0;
};
std::uint64_t hashOfBlock(const BlockHead&, std::span<const std::byte>);

std::vector<std::byte> bytesOf(const CheckpointHeader&);
// Of the tile all but its number and its planes.
void writeTile(const TileState&, ByteWriter&);
// False if it makes no sense, here and below.
bool readTile(ByteReader&, TileState&);
bool readHeaderBytes(std::span<const std::byte>, CheckpointHeader&);

} // namespace abbe
