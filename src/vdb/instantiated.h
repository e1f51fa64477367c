// Trees that the library has instantiated: their members come from there instead of being compiled in each
// unit that makes a tree, which was most of the time that this folder took to compile.
#pragma once

#include <openvdb/openvdb.h>

#ifdef __OPTIMIZE__ // without inlining more of them is needed than the library exports
namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

extern template class tree::Tree<BoolTree::RootNodeType>;
extern template class tree::Tree<DoubleTree::RootNodeType>;
extern template class tree::Tree<FloatTree::RootNodeType>;
extern template class tree::Tree<Int32Tree::RootNodeType>;
extern template class tree::Tree<Int64Tree::RootNodeType>;
extern template class tree::Tree<MaskTree::RootNodeType>;
extern template class tree::Tree<Vec3DTree::RootNodeType>;
extern template class tree::Tree<Vec3ITree::RootNodeType>;
extern template class tree::Tree<Vec3STree::RootNodeType>;

} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
#endif
