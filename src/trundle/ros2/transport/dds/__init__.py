"""Topics over Cyclone DDS, without ROS. It has no services and no actions: Fast DDS' clients would wait for ever."""
