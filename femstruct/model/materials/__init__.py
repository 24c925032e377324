"""What parts are made of beside isotropic materials: orthotropic ones, lay-ups, and the rigidities of plates."""
