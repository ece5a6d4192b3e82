‰PNG

