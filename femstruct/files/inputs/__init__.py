"""What a user names: ordinary files, columns of numbers, meshes of rooms. Nothing of it is written."""
