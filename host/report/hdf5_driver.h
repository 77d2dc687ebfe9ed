// HDF5 files that are whole whenever their program is killed: an HDF5 file driver over
// JournaledFile, which commits where HDF5 flushes a file. A plain HDF5 file comes of it.
#pragma once

#include <hdf5.h>

namespace impactdic::report::hdf5 {

// Makes the file access `access` use the driver. Returns less than 0 where HDF5 refuses.
herr_t use_journal(hid_t access);

}  // namespace impactdic::report::hdf5
