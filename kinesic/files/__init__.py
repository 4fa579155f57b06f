"""Safe reading and atomic writing of files, folders, films and glTF."""
